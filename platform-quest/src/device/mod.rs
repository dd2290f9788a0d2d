//! What only Android's Java classes tell of the device: battery, heat, name, folders, network, and
//! what other apps answer. Only this module calls Java, and only what stands in [`table`].
//!
//! The screen is kept on without Java: `ANativeActivity_setWindowFlags` does it from any thread,
//! `View` from the activity's own alone.

mod call;
pub mod table;
mod watch;

use std::ffi::c_void;
use std::path::PathBuf;

use jni::objects::{Global, JObject};
use jni::{Env, JValue, JavaVM};

pub use call::Error;
use call::{Caller, float, int, truth};
use table::{
    ABSOLUTE_PATH, ACTIVE_NETWORK, BATTERY_PROPERTY, CAPABILITIES, CLOSE, COLUMN_INDEX,
    CONTENT_RESOLVER, EXTERNAL_FILES_DIR, FILES_DIR, HAS_CAPABILITY, IS_CHARGING, MANUFACTURER,
    MODEL, MOVE_TO_NEXT, Member, PARSE_URI, QUERY, STRING, SYSTEM_SERVICE, THERMAL_HEADROOM,
    THERMAL_STATUS,
};
pub use watch::Watch;

/// The battery's state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Battery {
    /// What is left, in percent; none if the device does not know.
    pub percent: Option<u8>,
    /// Whether it is being charged.
    pub charging: bool,
}

/// How hot the device is, in Android's words.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[expect(missing_docs, reason = "Android has no more words for them either")]
pub enum Thermal {
    None = 0,
    Light = 1,
    Moderate = 2,
    Severe = 3,
    Critical = 4,
    Emergency = 5,
    Shutdown = 6,
}

/// How hot the device is, and will be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Heat {
    /// Now.
    pub status: Thermal,
    /// In ten seconds, 1 being where the device throttles; none if it does not know.
    pub headroom: Option<f32>,
}

/// The device, through a context of its Java side.
#[derive(Debug)]
pub struct Device {
    vm: JavaVM,
    context: Global<JObject<'static>>,
    level: i32,
}

/// Texts of a row of another app's; none where a column is missing or null.
pub type Row = Vec<Option<String>>;

/// Rows that are read of an answer: more than any has that is meant well.
pub const ROWS: usize = 256;

/// Names and numbers of Android's, from the pages of the classes that take them.
const BATTERY_SERVICE: &str = "batterymanager";
const POWER_SERVICE: &str = "power";
const CONNECTIVITY_SERVICE: &str = "connectivity";
const BATTERY_PROPERTY_CAPACITY: i32 = 4;
const NET_CAPABILITY_VALIDATED: i32 = 16;

/// How far ahead heat is asked for, in seconds: beyond it the device only guesses.
const FORECAST: i32 = 10;

impl Device {
    /// The device of an activity, or of another `android.content.Context`.
    ///
    /// # Safety
    /// The first is the process's Java VM, the second a reference to a context that is valid during
    /// this call.
    ///
    /// # Errors
    /// The thread can't be attached, or this is no Android.
    pub unsafe fn new(vm: *mut c_void, context: *mut c_void) -> Result<Self, Error> {
        // SAFETY: the caller says that it is one.
        let vm = unsafe { JavaVM::from_raw(vm.cast()) };
        let raw = context.cast();
        let (context, level) = vm.attach_current_thread(|env| -> Result<_, Error> {
            // SAFETY: the caller says that it is valid; a borrowed reference is never deleted here.
            let context = unsafe { env.as_cast_raw::<JObject<'_>>(&raw)? };
            let global = env.new_global_ref(&*context)?;
            Ok((global, Caller::level(env)?))
        })?;
        Ok(Device { vm, context, level })
    }

    /// The device's API level.
    #[must_use]
    pub const fn level(&self) -> i32 {
        self.level
    }

    /// Maker and model.
    ///
    /// # Errors
    /// Java's.
    pub fn name(&self) -> Result<String, Error> {
        self.call(|caller, _| {
            let mut words = Vec::new();
            for member in [MANUFACTURER, MODEL] {
                if let Some(value) = caller.class(member, &[])? {
                    words.extend(caller.string(member, value)?);
                }
            }
            Ok(words.join(" "))
        })
    }

    /// The battery's state.
    ///
    /// # Errors
    /// Java's.
    pub fn battery(&self) -> Result<Battery, Error> {
        self.call(|caller, context| {
            let mut battery = Battery { percent: None, charging: false };
            let Some(manager) = service(caller, context, BATTERY_SERVICE)? else {
                return Ok(battery);
            };
            let which = [JValue::Int(BATTERY_PROPERTY_CAPACITY)];
            if let Some(value) = caller.method(BATTERY_PROPERTY, &manager, &which)? {
                // A device that does not know answers with the least number there is.
                let percent = int(BATTERY_PROPERTY, value)?;
                battery.percent = u8::try_from(percent).ok().filter(|percent| *percent <= 100);
            }
            if let Some(value) = caller.method(IS_CHARGING, &manager, &[])? {
                battery.charging = truth(IS_CHARGING, value)?;
            }
            Ok(battery)
        })
    }

    /// How hot the device is.
    ///
    /// # Errors
    /// Java's.
    pub fn heat(&self) -> Result<Heat, Error> {
        self.call(|caller, context| {
            let mut heat = Heat { status: Thermal::None, headroom: None };
            let Some(manager) = service(caller, context, POWER_SERVICE)? else { return Ok(heat) };
            if let Some(value) = caller.method(THERMAL_STATUS, &manager, &[])? {
                heat.status = Thermal::of(int(THERMAL_STATUS, value)?);
            }
            let when = [JValue::Int(FORECAST)];
            if let Some(value) = caller.method(THERMAL_HEADROOM, &manager, &when)? {
                heat.headroom = Some(float(THERMAL_HEADROOM, value)?).filter(|it| it.is_finite());
            }
            Ok(heat)
        })
    }

    /// The folder for what is kept: where a computer sees it over USB, else the app's own.
    ///
    /// # Errors
    /// Java's, or there is neither.
    pub fn storage(&self) -> Result<PathBuf, Error> {
        self.call(|caller, context| {
            let own = JObject::null();
            let shared = caller.object(EXTERNAL_FILES_DIR, context, &[JValue::Object(&own)])?;
            let folder = match shared {
                Some(folder) => Some(folder),
                None => caller.object(FILES_DIR, context, &[])?,
            };
            let nowhere = |member: Member| Error { member: Some(member), why: "null".into() };
            let folder = folder.ok_or_else(|| nowhere(FILES_DIR))?;
            let path = caller.method(ABSOLUTE_PATH, &folder, &[])?;
            let path = path.map(|path| caller.string(ABSOLUTE_PATH, path)).transpose()?.flatten();
            path.map(PathBuf::from).ok_or_else(|| nowhere(ABSOLUTE_PATH))
        })
    }

    /// Whether the internet was reached over the network that is used.
    ///
    /// # Errors
    /// Java's.
    pub fn online(&self) -> Result<bool, Error> {
        self.call(|caller, context| {
            let Some(manager) = service(caller, context, CONNECTIVITY_SERVICE)? else {
                return Ok(false);
            };
            let Some(network) = caller.object(ACTIVE_NETWORK, &manager, &[])? else {
                return Ok(false);
            };
            let network = [JValue::Object(&network)];
            let Some(can) = caller.object(CAPABILITIES, &manager, &network)? else {
                return Ok(false);
            };
            let what = [JValue::Int(NET_CAPABILITY_VALIDATED)];
            let value = caller.method(HAS_CAPABILITY, &can, &what)?;
            value.map_or(Ok(false), |value| truth(HAS_CAPABILITY, value))
        })
    }

    /// Asks the app behind a `content://` address for columns of its rows; of [`ROWS`] at the most,
    /// and of none if there is no such app.
    ///
    /// # Errors
    /// Java's: a refused permission, say.
    pub fn query(&self, address: &str, columns: &[&str]) -> Result<Vec<Row>, Error> {
        self.call(|caller, context| {
            let Some(resolver) = caller.object(CONTENT_RESOLVER, context, &[])? else {
                return Ok(Vec::new());
            };
            let text = caller.text(address)?;
            let address = caller.class(PARSE_URI, &[JValue::Object(&text)])?;
            let Some(address) = address.and_then(|address| address.into_object().ok()) else {
                return Ok(Vec::new());
            };
            let (names, null) = (caller.texts(columns)?, JObject::null());
            let arguments = [&address, &names, &null, &null, &null].map(JValue::Object);
            let Some(cursor) = caller.object(QUERY, &resolver, &arguments)? else {
                return Ok(Vec::new());
            };
            let rows = rows(caller, &cursor, columns);
            caller.method(CLOSE, &cursor, &[])?;
            rows
        })
    }

    fn call<T>(
        &self,
        what: impl FnOnce(&mut Caller<'_, '_>, &JObject<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let inside =
            |env: &mut Env<'_>| what(&mut Caller::new(env, self.level), self.context.as_obj());
        self.vm.attach_current_thread(inside)
    }
}

impl Thermal {
    /// The status of a number of Android's. A later Android's own is taken for the worst.
    fn of(number: i32) -> Self {
        use Thermal::{Critical, Emergency, Light, Moderate, None, Severe, Shutdown};
        let all = [None, Light, Moderate, Severe, Critical, Emergency, Shutdown];
        let known = usize::try_from(number).map(|number| all.get(number).copied());
        known.map_or(None, |known| known.unwrap_or(Shutdown))
    }
}

fn service<'local>(
    caller: &mut Caller<'_, 'local>,
    context: &JObject<'_>,
    name: &str,
) -> Result<Option<JObject<'local>>, Error> {
    let name = caller.text(name)?;
    caller.object(SYSTEM_SERVICE, context, &[JValue::Object(&name)])
}

fn rows(
    caller: &mut Caller<'_, '_>,
    cursor: &JObject<'_>,
    columns: &[&str],
) -> Result<Vec<Row>, Error> {
    let mut places = Vec::new();
    for column in columns {
        let name = caller.text(column)?;
        let place = caller.method(COLUMN_INDEX, cursor, &[JValue::Object(&name)])?;
        places.push(place.map_or(Ok(-1), |place| int(COLUMN_INDEX, place))?);
    }
    let mut rows = Vec::new();
    while rows.len() < ROWS {
        let moved = caller.method(MOVE_TO_NEXT, cursor, &[])?;
        if !moved.map_or(Ok(false), |value| truth(MOVE_TO_NEXT, value))? {
            break;
        }
        let mut row = vec![None; columns.len()];
        for (text, place) in row.iter_mut().zip(&places).filter(|(_, place)| **place >= 0) {
            if let Some(value) = caller.method(STRING, cursor, &[JValue::Int(*place)])? {
                *text = caller.string(STRING, value)?;
            }
        }
        rows.push(row);
    }
    Ok(rows)
}
