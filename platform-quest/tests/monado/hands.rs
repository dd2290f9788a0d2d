//! The protocol of Monado's remote driver: one structure says where head and hands are and what they
//! press. Little-endian.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use glam::{Quat, Vec3};
use paros_shaders::gpu::{Eye, Fov};

/// Length of the structure.
const LEN: usize = 376;

/// Of the parts: views, the head's own pose, whether the views count, and the hands.
const VIEWS: usize = 8;
const VIEW_LEN: usize = 48;
const HEAD: usize = VIEWS + 2 * VIEW_LEN;
const VIEWS_COUNT: usize = HEAD + 28;
const HANDS: usize = VIEWS_COUNT + 4;
const HAND_LEN: usize = 120;

/// Within a hand: the numbers after its pose, speeds and curls, then what is on or off.
const TRIGGER: usize = 72;
const FLAGS: usize = 104;

/// A hand's controller.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    /// Where it is, in metres.
    pub(crate) position: Vec3,
    /// 0 to 1.
    pub(crate) trigger: f32,
    /// 0 to 1.
    pub(crate) squeeze: f32,
    /// Whether the controller is seen.
    pub(crate) active: bool,
    /// Whether the bare hand is seen.
    pub(crate) bare: bool,
}

impl Hand {
    /// A hand that does nothing.
    pub(crate) const fn at(x: f32, y: f32, z: f32) -> Hand {
        Hand { position: Vec3::new(x, y, z), trigger: 0.0, squeeze: 0.0, active: true, bare: false }
    }
}

/// A head and two hands on strings.
pub(crate) struct Hands {
    driver: TcpStream,
    bytes: [u8; LEN],
}

impl Hands {
    /// Takes the strings; the head looks ahead from where a standing visitor's is.
    pub(crate) fn connect() -> Hands {
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
        // What it starts from, and what is.
        driver.read_exact(&mut bytes).expect("a first structure");
        driver.read_exact(&mut bytes).expect("a second structure");
        bytes[..VIEWS].copy_from_slice(b"mndrmt3\0");
        Hands { driver, bytes }
    }

    /// Puts both eyes where they are to be, and the head between them.
    pub(crate) fn look(&mut self, eyes: &[Eye; 2]) {
        for (i, Eye { position, rotation, fov }) in eyes.iter().enumerate() {
            let Fov { left, right, up, down } = *fov;
            let at = VIEWS + i * VIEW_LEN;
            self.floats(at, &[left, right, up, down]);
            // Of the head.
            let from_head = *position - eyes[0].position.midpoint(eyes[1].position);
            self.pose(at + 16, rotation.inverse() * from_head, Quat::IDENTITY);
        }
        self.pose(HEAD, eyes[0].position.midpoint(eyes[1].position), eyes[0].rotation);
        self.bytes[VIEWS_COUNT] = 1;
        self.send();
    }

    /// Puts the left (0) or the right (1) hand where it is to be.
    pub(crate) fn hold(&mut self, hand: usize, to: Hand) {
        let at = HANDS + hand * HAND_LEN;
        self.pose(at, to.position, Quat::IDENTITY);
        self.floats(at + TRIGGER, &[to.trigger, to.squeeze]);
        self.bytes[at + FLAGS..][..2].copy_from_slice(&[to.bare, to.active].map(u8::from));
        self.send();
    }

    fn pose(&mut self, at: usize, position: Vec3, rotation: Quat) {
        let (p, q) = (position, rotation);
        self.floats(at, &[q.x, q.y, q.z, q.w, p.x, p.y, p.z]);
    }

    fn floats(&mut self, at: usize, values: &[f32]) {
        for (i, value) in values.iter().enumerate() {
            self.bytes[at + 4 * i..][..4].copy_from_slice(&value.to_le_bytes());
        }
    }

    fn send(&mut self) {
        self.driver.write_all(&self.bytes).expect("the driver listens");
    }
}
