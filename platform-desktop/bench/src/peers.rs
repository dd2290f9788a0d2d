//! Rivals that are Python packages (VTK, trimesh), in a child process with a line protocol: a request on
//! its standard input, an answer on its standard output.

use std::fmt;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use paros_core::volume::{BitGrid, Grid, Size};
use paros_shell::mesh::Mesh;

use super::clock::OursTheirs;

/// The Python program that answers requests.
const PROGRAM: &str = include_str!("peers.py");

/// The child process. Dropping it closes its input and waits for its end.
pub(super) struct PythonPeers {
    child: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

/// A Python package's version.
pub(super) type PackageVersion = String;

/// The times of our code beside a rival.
#[derive(Debug)]
pub(super) struct PeerTiming {
    pub(super) version: PackageVersion,
    /// The best time of each side, in milliseconds.
    pub(super) times_ms: OursTheirs<f64>,
    /// Number of runs of each side.
    pub(super) runs: usize,
}

/// The reason why a rival can't be run.
#[derive(Debug)]
pub(super) struct MissingPeer(String);

impl MissingPeer {
    /// Returns the reason that no benchmark of the plan needs the rival.
    pub(super) fn not_started() -> Self {
        MissingPeer("not started".into())
    }
}

impl fmt::Display for MissingPeer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<std::io::Error> for MissingPeer {
    fn from(error: std::io::Error) -> Self {
        MissingPeer(format!("Python broke off: {error}"))
    }
}

impl PythonPeers {
    /// Starts the interpreter, with its libraries limited to one thread.
    pub(super) fn start_python(python: &Path) -> Result<Self, MissingPeer> {
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
            .map_err(|error| {
                MissingPeer(format!("{} can't be started: {error}", python.display()))
            })?;
        let (requests, answers) = (child.stdin.take(), child.stdout.take());
        let answers = answers.ok_or_else(|| MissingPeer("Python has no output".into()))?;
        Ok(PythonPeers { child, requests, answers: BufReader::new(answers) })
    }

    /// Sends the voxels for the next runs. Returns VTK's version.
    pub(super) fn send_voxels<const N: usize>(
        &mut self,
        bit_grid: &BitGrid<N>,
    ) -> Result<PackageVersion, MissingPeer>
    where
        Grid<N>: Size,
    {
        let mut request = format!("voxels {N}\n").into_bytes();
        for y in 0..N {
            for z in 0..N {
                request.extend((0..N).map(|x| u8::from(bit_grid.contains([x, y, z]))));
            }
        }
        self.send_request(&request, "ready")
    }

    /// Sends the mesh for the next runs, with a voxel's side in mesh units. Returns trimesh's
    /// version.
    pub(super) fn send_mesh(
        &mut self,
        mesh: &Mesh,
        voxel_pitch: f64,
    ) -> Result<PackageVersion, MissingPeer> {
        let (vertices, triangles) = (&mesh.positions, &mesh.triangles);
        let head = format!("mesh {} {} {voxel_pitch}\n", vertices.len(), triangles.len());
        let mut request = head.into_bytes();
        request.extend(vertices.iter().flatten().flat_map(|c| c.to_le_bytes()));
        request.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
        self.send_request(&request, "ready")
    }

    /// Runs `edges`, `smooth` or `fill` once. Returns milliseconds by the child's clock.
    pub(super) fn run_request_ms(&mut self, request: &str) -> Result<f64, MissingPeer> {
        let answer = self.send_request(format!("{request}\n").as_bytes(), "ms")?;
        answer.parse().map_err(|_| MissingPeer(format!("Python answered {answer:?}")))
    }

    /// Sends a request and reads one answer line. Returns the text after `expected_word`.
    ///
    /// # Errors
    /// A package is missing, or the child has ended.
    fn send_request(&mut self, request: &[u8], expected_word: &str) -> Result<String, MissingPeer> {
        let gone = || MissingPeer("Python has gone".into());
        let requests = self.requests.as_mut().ok_or_else(gone)?;
        requests.write_all(request)?;
        requests.flush()?;
        let mut line = String::new();
        self.answers.read_line(&mut line)?;
        match line.trim_end().split_once(' ') {
            Some((first, rest)) if first == expected_word => Ok(rest.into()),
            Some(("missing", why)) => Err(MissingPeer(why.into())),
            _ => Err(gone()),
        }
    }
}

impl Drop for PythonPeers {
    fn drop(&mut self) {
        // The child ends when its input is closed.
        self.requests = None;
        let _ = self.child.wait();
    }
}
