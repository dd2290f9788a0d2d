//! Tests of voices.

use paros_models::allocations::without_allocating;

use super::*;

/// The power of each voice of [`VOICES`] in each ear after a tenth of a second, in decibels of full scale.
const LOUDNESS: [f32; 4] = [-28.5, -22.5, -26.7, -34.1];

#[test]
fn nothing_is_heard_while_nothing_runs() {
    let frames = mix(&[(SoundPlan::default(), 36)]);
    assert_eq!(frames.len(), SAMPLE_RATE as usize / 2);
    assert!(frames.as_flattened().iter().all(|sample| *sample == 0.0));
    assert!(Mixer::new(100).is_silent());
}

#[test]
fn every_voice_is_as_loud_as_it_should_be() {
    for ((name, voice), expected) in VOICES.into_iter().zip(LOUDNESS) {
        let frames = mix(&[(plan_of(voice), 72), (SoundPlan::default(), 36)]);
        keep(name, &frames);
        let second = SAMPLE_RATE as usize;
        for side in 0..2 {
            let loud = decibels(&frames[second / 10..second], side);
            assert!((loud - expected).abs() < 1.0, "{name}: {loud} dB");
        }
        assert!(frames[second + second / 4..].iter().all(|frame| *frame == [0.0; 2]), "{name}");
    }
}

/// Returns the amplitude of a tone in a second of frames.
fn amount_of_tone(frames: &[[f32; 2]], hz: f64) -> f64 {
    let turn = std::f64::consts::TAU * hz / f64::from(SAMPLE_RATE);
    let sums = frames.iter().enumerate().fold([0.0; 2], |[a, b], (i, frame)| {
        let (sin, cos) = (turn * i as f64).sin_cos();
        [a + f64::from(frame[0]) * sin, b + f64::from(frame[0]) * cos]
    });
    sums[0].hypot(sums[1]) / frames.len() as f64
}

#[test]
fn load_makes_a_motor_louder_and_lower() {
    let frames = |load| mix(&[(plan_of(VoicePlan { load, ..VOICES[0].1 }), 72)]);
    for (load, sounds, is_silent) in [(0.0, 330.0, 264.0), (1.0, 264.0, 330.0)] {
        let frames = frames(load);
        let [most, least] = [sounds, is_silent].map(|hz| amount_of_tone(&frames, hz));
        assert!(most > 10.0 * least, "{load}: {most} {least}");
    }
    let loudness = [0.0, 0.3, 0.6, 1.0].map(|load| decibels(&frames(load), 0));
    assert!(loudness.is_sorted() && loudness[3] > loudness[0] + 6.0, "{loudness:?}");
}

#[test]
fn starts_and_stops_do_not_click() {
    for (name, voice) in VOICES {
        let plan = plan_of(voice);
        // Stops at different phases of its waves.
        for ticks in 36..56 {
            let frames = mix(&[(plan, ticks), (SoundPlan::default(), 18)]);
            let stop = (0..ticks).map(frames_in_tick).sum::<usize>();
            let (sounding, stopping) = frames.split_at(stop);
            let steady = largest_step(&sounding[SAMPLE_RATE as usize / 10..]);
            let start = largest_step(&sounding[..SAMPLE_RATE as usize / 50]);
            let end = largest_step(&frames[stop - 1..]);
            assert!(start <= steady && end <= steady, "{name}: {start} {steady} {end}");
            assert!(sounding[0].iter().all(|first| first.abs() < 0.002), "{name}");
            assert!(stopping.last() == Some(&[0.0; 2]), "{name}");
        }
    }
}

#[test]
fn a_change_of_tool_or_side_does_not_click() {
    for (name, from) in VOICES {
        for (other, to) in VOICES {
            let steady = [from, to].map(|voice| largest_step(&mix(&[(plan_of(voice), 72)])));
            let [left, right] =
                [(from, -0.8), (to, 0.8)].map(|(voice, pan)| plan_of(VoicePlan { pan, ..voice }));
            let frames = mix(&[(left, 30), (right, 30), (left, 30)]);
            let most = 1.5 * (steady[0] + steady[1]);
            let step = largest_step(&frames);
            assert!(step <= most, "{name} to {other}: {step}, more than {most}");
        }
    }
}

#[test]
fn a_sound_is_where_its_hand_is() {
    for (name, voice) in VOICES {
        let heard = |pan| {
            let frames = mix(&[(plan_of(VoicePlan { pan, ..voice }), 36)]);
            decibels(&frames, 1) - decibels(&frames, 0)
        };
        let (left, middle, right) = (heard(-0.7), heard(0.0), heard(0.7));
        assert!(
            left < -6.0 && middle.abs() < 0.1 && right > 6.0,
            "{name}: {left} {middle} {right}"
        );
    }
}

#[test]
fn a_voice_is_heard_within_two_ticks() {
    let two_ticks = 2 * SAMPLE_RATE as usize / 72;
    for (name, voice) in VOICES {
        let frames = mix(&[(plan_of(voice), 36)]);
        let (early, steady) = (decibels(&frames[..two_ticks], 0), decibels(&frames, 0));
        assert!(early > steady - 6.0, "{name}: {early} of {steady} dB");
    }
}

#[test]
fn voices_end_where_no_tick_comes_any_more() {
    for (name, voice) in VOICES {
        let mut mixer = Mixer::new(100);
        let mut frames = mix_on(&mut mixer, &[(plan_of(voice), 36)]);
        let begin = frames.len();
        frames.resize(begin + SAMPLE_RATE as usize / 2, [0.0; 2]);
        for block in frames[begin..].chunks_mut(240) {
            mixer.render(block);
        }
        // A late frame leaves no gap.
        let late = &frames[begin..begin + SAMPLE_RATE as usize / 12];
        assert!(decibels(late, 0) > decibels(&frames[..begin], 0) - 3.0, "{name}");
        assert!(mixer.is_silent(), "{name}");
        assert!(largest_step(&frames[begin - 1..]) <= largest_step(&frames[..begin]), "{name}");
    }
}

#[test]
fn frames_are_the_same_however_many_are_asked_for() {
    let plan = plan_of(VOICES[1].1);
    let whole = mix(&[(plan, 20)]);
    let mut mixer = Mixer::new(100);
    let mut parts = vec![[0.0; 2]; whole.len()];
    let mut begin = 0;
    for tick in 0..20 {
        mixer.follow(&plan);
        let end = begin + frames_in_tick(tick);
        parts[begin..end].chunks_mut(7).for_each(|block| mixer.render(block));
        begin = end;
    }
    assert!(whole == parts);
}

#[test]
fn the_volume_is_a_part_of_full_and_nothing_is_allocated() {
    let plan = plan_of(VOICES[0].1);
    let at = |percent| mix_on(&mut Mixer::new(percent), &[(plan, 36)]);
    let full = decibels(&at(100), 0);
    assert!((decibels(&at(50), 0) - (full - 12.04)).abs() < 0.1);
    assert!(at(0).iter().all(|frame| *frame == [0.0; 2]));
    let mut mixer = Mixer::new(70);
    let mut frames = [[0.0; 2]; 240];
    without_allocating("mixing", || {
        for kind in SHOTS {
            mixer.follow(&plan_with(kind));
            mixer.follow(&plan);
            mixer.render(&mut frames);
        }
    });
}

#[test]
fn seventy_two_ticks_are_a_second() {
    for begin in [0, 1, 71, 1_000_000_007] {
        let frames: usize = (begin..begin + 72).map(frames_in_tick).sum();
        assert_eq!(frames, SAMPLE_RATE as usize);
    }
}
