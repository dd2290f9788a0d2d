//! The rivals that are Python packages, in a child process that runs once for each line it gets.

use std::fmt;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};

use crate::mesh::Mesh;

/// The child's program.
const PROGRAM: &str = include_str!("peers.py");

/// A Python that runs them. Ends when dropped.
pub(super) struct Peers {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

/// Why a rival does not run.
#[derive(Debug)]
pub(super) struct Missing(String);

impl Missing {
    /// None was asked for.
    pub(super) fn unneeded() -> Self {
        Missing("not started".into())
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<std::io::Error> for Missing {
    fn from(error: std::io::Error) -> Self {
        Missing(format!("Python broke off: {error}"))
    }
}

impl Peers {
    /// Starts Python, on one thread.
    pub(super) fn start(python: &Path) -> Result<Self, Missing> {
        let mut command = Command::new(python);
        for threads in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "VTK_SMP_MAX_THREADS"] {
            command.env(threads, "1");
        }
        let mut child = command
            .args(["-c", PROGRAM])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| Missing(format!("{} can't be started: {error}", python.display())))?;
        let (requests, answers) = (child.stdin.take(), child.stdout.take());
        let answers = answers.ok_or_else(|| Missing("Python has no output".into()))?;
        Ok(Peers { child, requests, answers: BufReader::new(answers) })
    }

    /// The next runs are on these voxels. What answers: VTK's version.
    pub(super) fn voxels<const N: usize>(&mut self, plane: &Plane<N>) -> Result<String, Missing>
    where
        Grid<N>: Size,
    {
        let mut request = format!("voxels {N}\n").into_bytes();
        for y in 0..N {
            for z in 0..N {
                request.extend((0..N).map(|x| u8::from(plane.contains([x, y, z]))));
            }
        }
        self.ask(&request, "ready")
    }

    /// The next runs are on this mesh, in voxels of `pitch`. What answers: trimesh's version.
    pub(super) fn mesh(&mut self, mesh: &Mesh, pitch: f64) -> Result<String, Missing> {
        let (vertices, triangles) = (&mesh.positions, &mesh.triangles);
        let head = format!("mesh {} {} {pitch}\n", vertices.len(), triangles.len());
        let mut request = head.into_bytes();
        request.extend(vertices.iter().flatten().flat_map(|c| c.to_le_bytes()));
        request.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
        self.ask(&request, "ready")
    }

    /// One run of `edges`, `smooth` or `fill`, in milliseconds.
    pub(super) fn run(&mut self, what: &str) -> Result<f64, Missing> {
        let answer = self.ask(format!("{what}\n").as_bytes(), "ms")?;
        answer.parse().map_err(|_| Missing(format!("Python answered {answer:?}")))
    }

    /// Sends a request; what follows the word that is expected in answer.
    fn ask(&mut self, request: &[u8], word: &str) -> Result<String, Missing> {
        let gone = || Missing("Python has gone".into());
        let requests = self.requests.as_mut().ok_or_else(gone)?;
        requests.write_all(request)?;
        requests.flush()?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        match line.trim_end().split_once(' ') {
            Some((first, rest)) if first == word => Ok(rest.into()),
            Some(("missing", why)) => Err(Missing(why.into())),
            _ => Err(gone()),
        }
    }
}

impl Drop for Peers {
    fn drop(&mut self) {
        // The end of its input ends it.
        self.requests = None;
        let _ = self.child.wait();
    }
}
