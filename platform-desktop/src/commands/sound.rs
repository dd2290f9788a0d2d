//! `paros sound`: renders the sound of a recorded session to a file.

use std::io::{self, Cursor, Write as _};
use std::path::PathBuf;

use hound::{SampleFormat, WavSpec, WavWriter};
use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_headless::{Error, show_progress};
use paros_shell::durable::WriteTarget;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::tick_runner::{ReplayedTick, TickRunner};
use paros_shell::trace::{ReplayDivergence, Trace};
use paros_shell::{with_intervals, with_size};
use paros_sound::{Mixer, SAMPLE_RATE, SoundPlanner, frames_in_tick};

use super::{play, volume};

/// Render the sound of a trace as a WAV file, as heard during the recording.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Trace to read.
    trace: PathBuf,
    /// WAV file to write: 48 kHz, two channels of 16 bits.
    #[arg(short, value_name = "F.wav")]
    output: PathBuf,
    /// Volume from which the trace's sessions start as the visitor's own.
    #[arg(long, value_name = "V.rmap")]
    volume: Option<PathBuf>,
    #[command(flatten)]
    layers: volume::LayersOption,
    /// Loudness in percent, 1 to 100.
    #[arg(long, value_name = "PERCENT", default_value_t = 70,
        value_parser = clap::value_parser!(u32).range(1..=100))]
    loudness: u32,
}

/// Bytes of a frame of two channels of 16 bits. A WAV file is limited to 4 GiB, in whole seconds.
const FRAME_BYTES: u64 = 4;

pub(super) fn run(args: &Args) -> Result<String, Error> {
    volume::refuse_other_extension(&args.output, "wav")?;
    for input in [Some(&args.trace), args.volume.as_ref()].into_iter().flatten() {
        volume::check_output_is_not_input(input, &args.output)?;
    }
    let target = WriteTarget::resolve_and_check_writable(&args.output)?;
    let trace = play::read_trace(&args.trace)?;
    let header = trace.header();
    args.layers.check_intervals_of(&args.trace, header.intervals.into())?;
    let second = u64::from(SAMPLE_RATE) * FRAME_BYTES;
    if trace.records().len() as u64 / u64::from(TICK_RATE) * second > u64::from(u32::MAX - 4096) {
        let path = args.trace.display();
        return Err(Error::Input(format!("{path}: is longer than the six hours of a WAV file")));
    }
    let unplayable = || {
        let why = ReplayDivergence::no_world_of_intervals(&header);
        Err(Error::Input(format!("{}: {why}", args.trace.display())))
    };
    let wav = with_size!(header.side, N => with_intervals!(
        usize::from(header.intervals),
        K => render_trace::<N, K>(args, &trace),
        else unplayable(),
    ))?;
    target.write_file(&wav)?;
    let seconds = trace.records().len() as f64 / f64::from(TICK_RATE);
    Ok(format!("{}: {seconds:.1} s\n", args.output.display()))
}

/// Returns the bytes of the WAV file.
fn render_trace<const N: usize, const K: usize>(
    args: &Args,
    trace: &Trace,
) -> Result<Vec<u8>, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut resident = Grid::<N>::lock_world();
    if let Some(path) = &args.volume {
        let filled = play::read_visitor_volume(
            &args.layers,
            path,
            resident.start_volumes.offer_visitor_volume(),
        )?;
        // Standard error may be closed.
        let _ = write!(io::stderr(), "{filled}");
    }
    resident.generate_starts();
    let WorldWithStarts { start_volumes, world } = &mut *resident;
    let hidden = start_volumes.hidden_figures();
    let mut runner = TickRunner::new(world, start_volumes.start_volumes(&hidden));
    let bar = show_progress("listening", Some(trace.records().len() as u64));
    let (mut planner, mut mixer) = (SoundPlanner::default(), Mixer::new(args.loudness));
    let mut inputs = trace.records().map(|record| record.input);
    let mut samples: Vec<i16> = Vec::new();
    let mut frames = [[0.0; 2]; (SAMPLE_RATE / TICK_RATE) as usize + 1];
    let replayed = runner.replay_on_same_start(trace, |ReplayedTick { index, world }| {
        let input = inputs.next().unwrap_or_default();
        mixer.follow(&planner.plan_tick(world, &input));
        let frames = &mut frames[..frames_in_tick(index as u64)];
        mixer.render(frames);
        samples.extend(frames.as_flattened().iter().map(|sample| (sample * 32767.0) as i16));
        if index % 64 == 0 {
            bar.set_steps_done(index as u64);
        }
    });
    replayed.map_err(|why| Error::Input(format!("{}: {why}", args.trace.display())))?;
    write_wav(&samples).map_err(Error::failure)
}

fn write_wav(samples: &[i16]) -> hound::Result<Vec<u8>> {
    let spec = WavSpec {
        channels: 2,
        sample_rate: SAMPLE_RATE,
        bits_per_sample: 16,
        sample_format: SampleFormat::Int,
    };
    let mut bytes = Cursor::new(Vec::with_capacity(2 * samples.len() + 44));
    let mut writer = WavWriter::new(&mut bytes, spec)?;
    samples.iter().try_for_each(|sample| writer.write_sample(*sample))?;
    writer.finalize()?;
    Ok(bytes.into_inner())
}
