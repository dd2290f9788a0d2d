//! Items light up where a hand would take them, and nothing else does.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use paros_core::internals::{STOOL_RADIUS, STOOL_TOP};
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit};
use paros_core::{HandInput, TickInput};
use paros_models::scripted_hand::{LEFT, RIGHT, hand_input_at, input_with_hand, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shaders::scene::{LIT, LIT_STOOL, LatestInput, MeshId, SceneAssembler};

fn lock_studio() -> MutexGuard<'static, WorldHarness<64>> {
    static STUDIO: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the meshes that are lit in a frame.
fn lit_meshes(studio: &WorldHarness<64>, light_targets: bool) -> Vec<MeshId> {
    let latest = LatestInput { light_targets, show_hands: true, ..LatestInput::default() };
    let mut scene = SceneAssembler::new();
    let list = scene.assemble_frame(&studio.world, &latest);
    let lit = |mesh: MeshId| {
        let tint = if mesh == MeshId::StoolTop { LIT_STOOL } else { LIT };
        list.instances_of(mesh).iter().any(|instance| instance.tint == tint)
    };
    let items = Tool::ALL.map(MeshId::of_tool).into_iter().chain(ToolBit::ALL.map(MeshId::of_bit));
    items.chain([MeshId::StoolTop]).filter(|mesh| lit(*mesh)).collect()
}

fn step_at(studio: &mut WorldHarness<64>, hand: usize, place: Vec3) {
    studio.step(&input_with_hand(hand, hand_input_at(place)));
}

#[test]
fn the_tool_that_a_hand_would_take_is_lit_with_its_bit() {
    let mut studio = lock_studio();
    let home = |item: BenchItem| item.home_position() + Vec3::new(0.02, 0.05, 0.01);
    for hand in [LEFT, RIGHT] {
        studio.start_session(SessionMode::FreeForm);
        for tool in Tool::ALL {
            step_at(&mut studio, hand, home(BenchItem::Tool(tool)));
            let expected = vec![MeshId::of_tool(tool), MeshId::of_bit(tool.default_bit())];
            assert_eq!(lit_meshes(&studio, true), expected, "{tool:?}");
            assert_eq!(lit_meshes(&studio, false), []);
        }
        // A bit is lit only for the tool that it fits, and a held item isn't lit.
        let ball = BenchItem::Bit(ToolBit::LargeBall);
        step_at(&mut studio, hand, home(ball));
        assert_eq!(lit_meshes(&studio, true), []);
        take_item(&mut studio, hand, BenchItem::Tool(Tool::Rotary));
        step_at(&mut studio, hand, home(ball));
        assert_eq!(lit_meshes(&studio, true), [MeshId::of_bit(ToolBit::LargeBall)]);
        step_at(&mut studio, hand, Vec3::new(0.0, 1.4, 0.0));
        assert_eq!(lit_meshes(&studio, true), []);
    }
}

#[test]
fn each_hand_lights_its_own_and_the_stool_stays_lit_while_it_is_held() {
    let mut studio = lock_studio();
    studio.start_session(SessionMode::FreeForm);
    let rim = STOOL_TOP + Vec3::new(-0.3, 0.02, STOOL_RADIUS - 0.1);
    let rasp = BenchItem::Tool(Tool::Rasp).home_position();
    let mut hands = [rim, rasp].map(hand_input_at);
    studio.step(&TickInput { hands, ..TickInput::default() });
    let of_rasp = [MeshId::Rasp, MeshId::of_bit(Tool::Rasp.default_bit())];
    let all = [of_rasp[0], of_rasp[1], MeshId::StoolTop];
    assert_eq!(lit_meshes(&studio, true), all);
    // The hand has left the rim, but still squeezes.
    for place in [rim, rim - Vec3::X * 0.2] {
        hands[LEFT] = HandInput { squeeze: 255, ..hand_input_at(place) };
        studio.step(&TickInput { hands, ..TickInput::default() });
        assert_eq!(lit_meshes(&studio, true), all);
    }
    hands[LEFT].squeeze = 0;
    studio.step(&TickInput { hands, ..TickInput::default() });
    assert_eq!(lit_meshes(&studio, true), of_rasp);
    // An untracked hand takes nothing.
    hands[RIGHT].tracked = false;
    studio.step(&TickInput { hands, ..TickInput::default() });
    assert_eq!(lit_meshes(&studio, true), []);
}
