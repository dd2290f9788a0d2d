//! Tests of shots.

use super::*;

/// The valid peaks of sounds, and the longest duration.
const PEAKS: core::ops::Range<f32> = 0.08..0.55;
const LONGEST_SECONDS: usize = 11;

/// Mixes a sound from its beginning to its end.
fn mix_to_end(kind: ShotKind) -> Vec<[f32; 2]> {
    let mut mixer = Mixer::new(100);
    let mut frames = mix_on(&mut mixer, &[(plan_with(kind), 1)]);
    while !mixer.is_silent() {
        mixer.follow(&SoundPlan::default());
        let begin = frames.len();
        frames.resize(begin + 480, [0.0; 2]);
        mixer.render(&mut frames[begin..]);
        assert!(frames.len() < LONGEST_SECONDS * SAMPLE_RATE as usize, "{kind:?} doesn't end");
    }
    frames
}

fn peak_of(frames: &[[f32; 2]]) -> f32 {
    frames.as_flattened().iter().fold(0.0, |peak, sample| peak.max(sample.abs()))
}

#[test]
fn all_at_once_is_kept_under_full_scale() {
    let mut plan = plan_of(VoicePlan { load: 1.0, pan: -0.85, ..VOICES[1].1 });
    plan.voices[0] = VoicePlan { load: 1.0, pan: -0.85, ..VOICES[2].1 };
    for kind in [[ShotKind::Flake; 10], [ShotKind::Bared { tenths: 1 }; 10]].concat() {
        plan.push(Shot { kind, strength: 1.0, pan: -0.85 });
    }
    let frames = mix(&[(plan, 72)]);
    // Without the limiter the peak would exceed full scale.
    assert!((0.85..1.0).contains(&peak_of(&frames)), "{}", peak_of(&frames));
}

#[test]
fn every_sound_is_heard_and_ends_without_a_click() {
    for kind in SHOTS {
        let frames = mix_to_end(kind);
        keep(&format!("{kind:?}").replace([' ', '{', '}', ':'], ""), &frames);
        let peak = peak_of(&frames);
        assert!(PEAKS.contains(&peak), "{kind:?}: {peak}");
        assert!(frames[0].iter().all(|first| first.abs() < 0.01), "{kind:?} begins at once");
        assert!(largest_step(&frames) < 0.15, "{kind:?}: {}", largest_step(&frames));
        assert_eq!(frames.last(), Some(&[0.0; 2]), "{kind:?}");
    }
}

#[test]
fn sounds_begin_within_two_ticks_but_what_falls_lands_later() {
    for kind in SHOTS {
        let frames = mix_to_end(kind);
        let early = &frames[..2 * SAMPLE_RATE as usize / 72];
        assert!(decibels(early, 0) > -50.0, "{kind:?}: {}", decibels(early, 0));
    }
    let fall = mix_to_end(ShotKind::Fall);
    let third = SAMPLE_RATE as usize / 3;
    let (flight, ground) = (&fall[third / 2..third], &fall[third..4 * third / 3]);
    assert!(decibels(ground, 0) > decibels(flight, 0) + 6.0);
}

/// Counts how often the power of 40 ms rises to twice that of the 40 ms before.
fn count_onsets(frames: &[[f32; 2]]) -> usize {
    let levels: Vec<f32> =
        frames.chunks(SAMPLE_RATE as usize / 25).map(|c| decibels(c, 0)).collect();
    1 + levels.windows(2).filter(|pair| pair[1] > pair[0] + 3.0).count()
}

#[test]
fn the_clock_strikes_as_often_as_it_should() {
    for strokes in 1..=3 {
        let onsets = count_onsets(&mix_to_end(ShotKind::Clock { strokes }));
        assert_eq!(onsets, usize::from(strokes));
    }
}

#[test]
fn the_figure_rings_higher_the_more_of_it_is_bared() {
    let mut last = 0;
    for tenths in 1..=10 {
        let frames = mix_to_end(ShotKind::Bared { tenths });
        // The time after the upper partials have faded.
        let tail = &frames[SAMPLE_RATE as usize..2 * SAMPLE_RATE as usize];
        let is_zero = |pair: &&[[f32; 2]]| pair[0][0] < 0.0 && pair[1][0] >= 0.0;
        let hertz = tail.windows(2).filter(is_zero).count();
        assert!(hertz > last, "{tenths}: {hertz} after {last}");
        last = hertz;
    }
}

#[test]
fn the_clock_is_heard_among_all_chips() {
    let mut mixer = Mixer::new(100);
    let mut plan = plan_of(VoicePlan { load: 1.0, ..VOICES[1].1 });
    plan.voices[0] = VoicePlan { load: 1.0, ..VOICES[2].1 };
    for kind in [ShotKind::Blow, ShotKind::Flake, ShotKind::Flake, ShotKind::Chip] {
        plan.push(Shot { kind, strength: 1.0, pan: -0.3 });
    }
    mix_on(&mut mixer, &[(plan, 36)]);
    let mut without = mixer.clone();
    without.follow(&plan);
    plan.push(Shot { kind: ShotKind::Clock { strokes: 1 }, strength: 1.0, pan: 0.0 });
    mixer.follow(&plan);
    let (mut with_clock, mut all) = (vec![[0.0; 2]; 9600], vec![[0.0; 2]; 9600]);
    mixer.render(&mut with_clock);
    without.render(&mut all);
    let difference: Vec<[f32; 2]> =
        with_clock.iter().zip(&all).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).collect();
    assert!(decibels(&difference, 0) > -35.0, "{}", decibels(&difference, 0));
}
