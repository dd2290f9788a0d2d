//! The protocol of Monado's remote driver: one structure holds the poses of head and hands, and the
//! inputs of both controllers. Little-endian.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};
use paros_shaders::gpu::{Eye, Fov};

/// Length of the structure in bytes.
const LEN: usize = 376;

/// Byte offsets of the views, the head's pose, the flag for valid views, and the hands.
const VIEWS: usize = 8;
const VIEW_LEN: usize = 48;
const HEAD: usize = VIEWS + 2 * VIEW_LEN;
const VIEWS_COUNT: usize = HEAD + 28;
const HANDS: usize = VIEWS_COUNT + 4;
const HAND_LEN: usize = 120;

/// Byte offsets within a hand: first pose, velocities and curls, then the analogue inputs, then the flags.
const TRIGGER: usize = 72;
const FLAGS: usize = 104;

/// The state of one hand's controller in the driver's format.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RemoteHand {
    /// The position in metres.
    pub(crate) position: Vec3,
    /// The rotation: without one, the hand points along -z.
    pub(crate) rotation: Quat,
    /// The input's value, 0 to 1.
    pub(crate) trigger: f32,
    /// The input's value, 0 to 1.
    pub(crate) squeeze: f32,
    /// `true` if the controller is tracked.
    pub(crate) active: bool,
    /// `true` if the bare hand is tracked.
    pub(crate) bare: bool,
}

impl RemoteHand {
    /// Creates a hand at a position in metres, with nothing pressed.
    pub(crate) const fn at(x: f32, y: f32, z: f32) -> RemoteHand {
        RemoteHand {
            position: Vec3::new(x, y, z),
            rotation: Quat::IDENTITY,
            trigger: 0.0,
            squeeze: 0.0,
            active: true,
            bare: false,
        }
    }
}

/// A connection to Monado's remote driver, which sets the head's and both hands' poses.
pub(crate) struct RemoteHands {
    driver: TcpStream,
    bytes: [u8; LEN],
}

impl RemoteHands {
    /// Connects to the driver, and waits up to 20 s for it. The head's pose is the driver's default.
    ///
    /// # Panics
    /// The driver does not answer.
    pub(crate) fn connect() -> RemoteHands {
        let begun = Instant::now();
        let mut driver = loop {
            match TcpStream::connect("127.0.0.1:4242") {
                Ok(driver) => break driver,
                Err(error) => assert!(begun.elapsed() < Duration::from_secs(20), "{error}"),
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        driver.set_nodelay(true).expect("no delay");
        let mut bytes = [0; LEN];
        // The driver sends its initial state, then its current state.
        driver.read_exact(&mut bytes).expect("a first structure");
        driver.read_exact(&mut bytes).expect("a second structure");
        bytes[..VIEWS].copy_from_slice(b"mndrmt3\0");
        RemoteHands { driver, bytes }
    }

    /// Sets both eyes' poses and fields of view, and the head's pose between them.
    pub(crate) fn place_eyes(&mut self, eyes: &[Eye; 2]) {
        for (i, Eye { position, rotation, fov }) in eyes.iter().enumerate() {
            let Fov { left, right, up, down } = *fov;
            let at = VIEWS + i * VIEW_LEN;
            self.write_floats(at, &[left, right, up, down]);
            // The position relative to the head.
            let from_head = *position - eyes[0].position.midpoint(eyes[1].position);
            self.write_pose(at + 16, rotation.inverse() * from_head, Quat::IDENTITY);
        }
        self.write_pose(HEAD, eyes[0].position.midpoint(eyes[1].position), eyes[0].rotation);
        self.bytes[VIEWS_COUNT] = 1;
        self.send_state();
    }

    /// Sets the state of the left (0) or the right (1) hand.
    pub(crate) fn place_hand(&mut self, hand: usize, to: RemoteHand) {
        let at = HANDS + hand * HAND_LEN;
        self.write_pose(at, to.position, to.rotation);
        self.write_floats(at + TRIGGER, &[to.trigger, to.squeeze]);
        self.bytes[at + FLAGS..][..2].copy_from_slice(&[to.bare, to.active].map(u8::from));
        self.send_state();
    }

    fn write_pose(&mut self, at: usize, position: Vec3, rotation: Quat) {
        let (p, q) = (position, rotation);
        self.write_floats(at, &[q.x, q.y, q.z, q.w, p.x, p.y, p.z]);
    }

    fn write_floats(&mut self, at: usize, values: &[f32]) {
        for (i, value) in values.iter().enumerate() {
            self.bytes[at + 4 * i..][..4].copy_from_slice(&value.to_le_bytes());
        }
    }

    fn send_state(&mut self) {
        self.driver.write_all(&self.bytes).expect("the driver listens");
    }
}
