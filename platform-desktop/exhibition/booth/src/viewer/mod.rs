//! The 3D viewer of a sculpture: three.js, served by the booth itself.

use std::sync::LazyLock;

use axum::Router;
use axum::http::{HeaderName, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use maud::{Markup, html};
use paros_core::badge::Language;
use paros_shaders::constants::{AMBIENT_HARMONICS, SUN_COLOR, SUN_DIRECTION, TONE_WHITE_POINT};

use crate::models::model::ModelFormat;
use crate::models::picture::{PICTURE_AZIMUTH, PICTURE_ELEVATION};

/// The headers of the viewer's files. Caches may share the files, as they are the same for everybody.
const HEADERS: [(HeaderName, &str); 3] = [
    (header::CONTENT_TYPE, "text/javascript"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::CACHE_CONTROL, "public, max-age=86400"),
];

/// three.js' orbit controls, with the import rewritten to a relative address, as browsers don't resolve
/// package names.
static CONTROLS: LazyLock<String> = LazyLock::new(|| {
    include_str!("OrbitControls.js").replace("from 'three';", "from './three.module.min.js';")
});

/// Makes the routes of the viewer's files.
pub(crate) fn router<S: Clone + Send + Sync + 'static>() -> Router<S> {
    Router::new()
        .route("/viewer/viewer.js", get(|| async { script(include_str!("viewer.js")) }))
        .route("/viewer/OrbitControls.js", get(|| async { script(&CONTROLS) }))
        .route(
            "/viewer/three.module.min.js",
            get(|| async { script(include_str!("three.module.min.js")) }),
        )
        .route(
            "/viewer/three.core.min.js",
            get(|| async { script(include_str!("three.core.min.js")) }),
        )
}

/// The reflectance of the stone: marble without veins.
const STONE: [f32; 3] = [0.84, 0.83, 0.81];

/// Writes the studio's light and the view of [`draw_volume`](crate::models::picture::draw_volume) as JSON, so
/// that the viewer starts with the same view as the picture.
fn write_light() -> String {
    serde_json::json!({
        "sun": SUN_DIRECTION,
        "sunColour": SUN_COLOR,
        "ambient": AMBIENT_HARMONICS,
        "white": TONE_WHITE_POINT,
        "stone": STONE,
        "azimuth": PICTURE_AZIMUTH,
        "elevation": PICTURE_ELEVATION,
    })
    .to_string()
}

/// Draws a menu button with the download links of the sculpture whose page has the address `at`.
pub(crate) fn draw_downloads(at: &str, language: Language) -> Markup {
    let (download, uses) = match language {
        Language::English => ("Download", ["any 3D printer", "3D printer, with units", "screens"]),
        Language::Greek => ("Λήψη", ["κάθε 3D εκτυπωτής", "3D εκτυπωτής, με μονάδες", "οθόνες"]),
    };
    html! {
        details class="menu" {
            summary class="button" { (download) }
            @for (format, used) in ModelFormat::ALL.into_iter().zip(uses) {
                a href={ (at) "/model." (format.ending()) } { (format.name()) " " small { (used) } }
            }
        }
    }
}

/// Draws the viewer of a model's address. The model is loaded when somebody presses the button.
pub(crate) fn draw_viewer(model: &str, language: Language) -> Markup {
    let (turn, how, fault) = match language {
        Language::English => (
            "Turn it in 3D",
            "Drag to turn, pinch or roll the wheel to come closer; arrow keys, plus and minus do the same.",
            "This browser can't draw it.",
        ),
        Language::Greek => (
            "Περιστροφή σε 3D",
            "Σύρετε για περιστροφή, τσιμπήστε ή κυλήστε τη ροδέλα για μεγέθυνση· το ίδιο κάνουν τα βέλη, το συν και το πλην.",
            "Αυτό το πρόγραμμα δεν μπορεί να το δείξει.",
        ),
    };
    html! {
        div class="viewer" data-model=(model) data-light=(write_light()) data-fault=(fault) {
            button type="button" { (turn) }
            canvas hidden tabindex="0" role="img" aria-label=(how) {}
            p hidden { (how) }
        }
        script type="module" src="/viewer/viewer.js" {}
    }
}

fn script(text: &'static str) -> Response {
    (HEADERS, text).into_response()
}

#[cfg(test)]
mod tests {
    use super::CONTROLS;

    #[test]
    fn no_file_asks_for_a_name_that_browsers_do_not_know() {
        assert!(CONTROLS.contains("} from './three.module.min.js';"));
        let code = CONTROLS.lines().filter(|line| !line.trim_start().starts_with('*'));
        assert!(!code.collect::<Vec<_>>().concat().contains("from 'three"));
    }
}
