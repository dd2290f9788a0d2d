//! Automatic choice of the studio's size: the size of the session under way, else the fine size if the
//! machine draws it at the full rate, else the usual one.

use std::fmt;
use std::path::Path;
use std::time::{Duration, Instant};

use paros_core::codec::session_of_save;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::volume::{Grid, Size};
use paros_headless::{Error, HeadlessRenderer, PictureFormat, SculptureView};
use paros_shaders::Camera;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{FrameRequest, RenderPath, RenderStyle};
use paros_shaders::scene::{LatestInput, SKY, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shell::durable;
use paros_shell::figures::Figure;
use paros_shell::sizes::GRID_SIDES;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::studio_paths::StudioPaths;

use super::libraries;

/// Voxels along an edge of the usual studio.
const USUAL: usize = GRID_SIDES[0];
/// Voxels along an edge of the fine studio.
const FINE: usize = GRID_SIDES[1];

/// Duration of the measurement.
const MEASURED_FOR: Duration = Duration::from_millis(500);

/// Time limit of a picture: two thirds of 1/72 s. The rest is for a tick and the panels.
const DRAWN_WITHIN: Duration = Duration::from_micros(9_250);

/// Format of the measured picture: a window of usual size.
const PICTURE: PictureFormat = PictureFormat { size: [1280, 800], eyes: 1, samples: 4 };

/// A size of the studio, and the reason of the choice.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SizeChoice {
    /// Voxels along an edge.
    pub grid_side: usize,
    reason: SizeReason,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum SizeReason {
    /// A session of this size is under way.
    UnderWay,
    /// A picture in the fine size took this time.
    Drawn(Duration),
    /// There is no GPU to measure.
    NoGpu,
}

impl SizeChoice {
    /// Chooses the size of a studio that saves to `folder`, or to the user's own. Unless a session is under
    /// way, the function draws for half a second to measure the machine.
    #[must_use]
    pub fn choose(folder: Option<&Path>) -> Self {
        let paths = StudioPaths::for_user(folder);
        // Without a display there is no window, so that no measurement is needed.
        let has_display = libraries::check_display_and_libraries().is_ok();
        let picture = || if has_display { measure_picture::<FINE>() } else { Ok(None) };
        let measured = || match picture() {
            Ok(Some(taken)) => SizeChoice::of_picture(taken),
            // The window later reports faults of the device.
            Ok(None) | Err(_) => SizeChoice { grid_side: USUAL, reason: SizeReason::NoGpu },
        };
        let under_way = find_session_under_way(&paths);
        under_way.map_or_else(measured, |grid_side| SizeChoice {
            grid_side,
            reason: SizeReason::UnderWay,
        })
    }

    fn of_picture(taken: Duration) -> Self {
        let grid_side = if taken <= DRAWN_WITHIN { FINE } else { USUAL };
        SizeChoice { grid_side, reason: SizeReason::Drawn(taken) }
    }
}

impl fmt::Display for SizeChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = self.grid_side;
        write!(f, "{side} voxels a side: ")?;
        match self.reason {
            SizeReason::UnderWay => write!(f, "a sculpture of this size is under way"),
            SizeReason::Drawn(taken) => {
                let ms = taken.as_secs_f64() * 1e3;
                write!(f, "this machine draws a picture of {FINE} in {ms:.1} ms")
            }
            SizeReason::NoGpu => write!(f, "this machine draws without a GPU"),
        }?;
        write!(f, " (--size decides otherwise)")
    }
}

/// Returns the size of the session under way. If there are two, the one saved last counts.
fn find_session_under_way(paths: &StudioPaths) -> Option<usize> {
    let saves = GRID_SIDES.into_iter().filter_map(|side| {
        let path = paths.session_file(side);
        let bytes = durable::read_regular_file(&path).ok()?;
        let is_under_way = session_of_save(&bytes) == Some(SessionState::Sculpting);
        let saved = path.metadata().and_then(|data| data.modified()).ok()?;
        is_under_way.then_some((saved, side))
    });
    saves.max().map(|(_, side)| side)
}

/// Measures the median time of a picture of the lump in the room. Returns `None` on a software device, which
/// is never fast enough.
fn measure_picture<const N: usize>() -> Result<Option<Duration>, Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let gpu = paros_headless::open_gpu(None)?;
    if gpu.is_software() {
        return Ok(None);
    }
    let mut maps = Grid::<N>::lock_range_maps();
    Figure::Lump.rasterize_into(&mut maps, &mut Grid::<N>::lock_bit_grid());
    let mut field = Box::new(DensityField::<N, INTERVALS>::new());
    field.rebuild_from(&maps);
    let volume = VolumeFormat::of::<N, INTERVALS>();
    let mut renderer = HeadlessRenderer::new(&gpu, volume, PICTURE, &[])?;
    renderer.load_field(&field)?;
    let mut room = Box::new(SceneAssembler::new());
    room.assemble_frame(&Grid::<N>::lock_world().world, &LatestInput::default());
    let camera = Camera::orbiting(0.35, 0.2);
    let view = paros_headless::view_of_camera(&camera, PICTURE.size);
    let SculptureView { eye, placement } = view.moved_onto(&room.sculpture_placement());
    let style = RenderStyle::in_studio(RenderPath::Fast);
    let scene = Some(room.draw_list());
    let request =
        FrameRequest { eyes: &[eye], placement, style, backdrop: SKY, scene, panels: &[] };
    // The first picture creates resources that later pictures reuse.
    renderer.draw_frame(&request, &vec![])?;
    let (begun, mut taken) = (Instant::now(), Vec::new());
    while begun.elapsed() < MEASURED_FOR {
        let frame = Instant::now();
        renderer.draw_frame(&request, &vec![])?;
        taken.push(frame.elapsed());
    }
    taken.sort_unstable();
    Ok(taken.get(taken.len() / 2).copied())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::{Duration, Instant};

    use paros_core::TickInput;
    use paros_core::limits::{INTERVALS, max_save_bytes};
    use paros_core::session::{SessionMode, commands};
    use paros_core::volume::{Grid, Size};
    use paros_shell::statics::Resident;
    use paros_shell::studio_paths::StudioPaths;
    use paros_shell::tick_runner::with_fresh_world;

    use super::{FINE, SizeChoice, find_session_under_way, measure_picture};

    /// Encodes the save of a session that is under way, or finished.
    fn save_session<const N: usize>(is_finished: bool) -> Vec<u8>
    where
        Grid<N>: Size + Resident<N, INTERVALS>,
    {
        with_fresh_world::<N, INTERVALS, _>(|mut runner| {
            runner.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
            let commands = if is_finished { commands::FINISH } else { 0 };
            runner.run_tick(&TickInput { commands, ..TickInput::default() });
            let mut bytes = vec![0; max_save_bytes(N, INTERVALS)];
            let len = runner.world().save(&mut bytes);
            bytes.truncate(len);
            bytes
        })
    }

    #[test]
    fn a_session_under_way_goes_on_at_its_size() {
        let folder = std::env::temp_dir().join(format!("paros-size-choice-{}", std::process::id()));
        let paths = StudioPaths::inside_folder(&folder);
        fs::create_dir_all(&paths.sessions).unwrap();
        assert_eq!(find_session_under_way(&paths), None);
        fs::write(paths.session_file(128), save_session::<128>(false)).unwrap();
        assert_eq!(find_session_under_way(&paths), Some(128));
        std::thread::sleep(Duration::from_millis(20));
        fs::write(paths.session_file(256), save_session::<256>(false)).unwrap();
        assert_eq!(find_session_under_way(&paths), Some(256), "the last one");
        fs::write(paths.session_file(256), save_session::<256>(true)).unwrap();
        assert_eq!(find_session_under_way(&paths), Some(128), "the other is finished");
        fs::write(paths.session_file(128), b"PWLD").unwrap();
        assert_eq!(find_session_under_way(&paths), None);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    #[ignore = "needs a GPU"]
    fn a_gpu_is_measured_for_half_a_second() {
        let begun = Instant::now();
        let taken = measure_picture::<FINE>().expect("Vulkan").expect("no software");
        println!(
            "{}; decided in {:.1} s",
            SizeChoice::of_picture(taken),
            begun.elapsed().as_secs_f32()
        );
        assert!(taken > Duration::from_micros(50), "{taken:?} for 1280x800 at 4 samples");
    }

    #[test]
    fn the_fine_size_is_for_machines_that_draw_it_at_their_rate() {
        let of = |us| SizeChoice::of_picture(Duration::from_micros(us));
        assert_eq!([of(9_000), of(9_500)].map(|choice| choice.grid_side), [256, 128]);
        let told = "128 voxels a side: this machine draws a picture of 256 in 9.5 ms (--size decides otherwise)";
        assert_eq!(of(9_500).to_string(), told);
    }
}
