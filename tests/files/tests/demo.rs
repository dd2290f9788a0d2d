//! What the demo leaves is what its chapters say.

use std::ops::ControlFlow;

use paros_models::dense::DenseVolume;
use paros_shell::demo::{Chapter, play_demo};
use paros_shell::tick_runner::with_fresh_world;

/// No crumb stands beside the figure, and all the paste of the necklace is at the neck.
#[test]
fn the_owl_stands_alone_with_its_beads_at_the_neck() {
    let mut chapters = vec![];
    with_fresh_world::<128, _>(|mut stage| {
        play_demo(&mut stage, 0, &mut |_| ControlFlow::Continue(()), |chapter, world| {
            chapters.push((chapter, DenseVolume::from_maps(world.volume().maps())));
        });
    });
    let after =
        |wanted| &chapters.iter().find(|(chapter, _)| *chapter == wanted).expect("it was").1;
    let finished = after(Chapter::Finished);
    let first = finished.occupied().next().expect("stone");
    let loose = finished.difference(&finished.connected_to(vec![first]));
    assert!(loose.is_empty(), "{} loose voxels at {:?}", loose.count(), loose.occupied().next());

    let beads = finished.difference(after(Chapter::Undone));
    assert!(beads.count() > 1000, "{} voxels of paste", beads.count());
    let neck = 52..84;
    let off = beads.occupied().find(|[_, y, _]| !neck.contains(y));
    assert_eq!(off, None, "paste beside the neck");
}
