//! The device's state that only Android's Java classes report: battery, thermal state, model, boots, storage
//! folders, network, content providers, managed configuration, and HTTPS. Calls go through JNI, and only to
//! the members in [`table`].
//!
//! The screen is kept on without Java: `ANativeActivity_setWindowFlags` may be called from any thread,
//! the methods of `View` only from the activity's own.

mod call;
mod https;
mod managed;
mod monitor;
pub mod table;

use std::ffi::c_void;
use std::path::PathBuf;

use jni::objects::{Global, JObject};
use jni::{Env, JValue, JavaVM};
use paros_headset::runtime::ContentRow;
use paros_protocol::LinkTimes;
use paros_shell::headset::device_health::{Battery, ThermalReading, ThermalStatus};
use paros_upload::{BoothAddress, ThreadedLink};

pub use call::JavaError;
use call::{JavaCaller, read_bool, read_float, read_int};
pub use https::HttpsCaller;
pub use managed::ManagedEntry;
pub use monitor::DeviceMonitor;
use table::{
    ABSOLUTE_PATH, ACTIVE_NETWORK, BATTERY_PROPERTY, CAPABILITIES, CLOSE, COLUMN_INDEX,
    CONTENT_RESOLVER, EXTERNAL_FILES_DIR, FILES_DIR, GLOBAL_INT, HAS_CAPABILITY, IS_CHARGING,
    MANUFACTURER, MODEL, MOVE_TO_NEXT, PARSE_URI, QUERY, SECURE_STRING, STRING, SYSTEM_SERVICE,
    THERMAL_HEADROOM, THERMAL_STATUS,
};

/// An Android device, accessed through a Java context.
#[derive(Debug)]
pub struct AndroidDevice {
    vm: JavaVM,
    context: Global<JObject<'static>>,
    api_level: i32,
}

/// The maximum number of rows that are read from a query's result: a bound against a faulty content provider.
pub const MAX_ROWS: usize = 256;

/// Constants of Android, from the reference pages of the classes that take them.
const BATTERY_SERVICE: &str = "batterymanager";
const POWER_SERVICE: &str = "power";
const CONNECTIVITY_SERVICE: &str = "connectivity";
const BATTERY_PROPERTY_CAPACITY: i32 = 4;
const NET_CAPABILITY_VALIDATED: i32 = 16;
/// `Settings.Secure.ANDROID_ID`.
const ANDROID_ID: &str = "android_id";
/// `Settings.Global.BOOT_COUNT`, since API level 24.
const BOOT_COUNT: &str = "boot_count";

/// The forecast time of the thermal headroom, in seconds: a longer forecast is unreliable.
const FORECAST_SECONDS: i32 = 10;

impl AndroidDevice {
    /// Creates the device from an activity, or from another `android.content.Context`.
    ///
    /// # Safety
    /// `vm` is the process's Java VM, and `context` a reference to a context that is valid during this call.
    ///
    /// # Errors
    /// The thread can't be attached, or this is not Android.
    pub unsafe fn from_raw(vm: *mut c_void, context: *mut c_void) -> Result<Self, JavaError> {
        // SAFETY: the caller says that it is one.
        let vm = unsafe { JavaVM::from_raw(vm.cast()) };
        let raw = context.cast();
        let (context, api_level) = vm.attach_current_thread(|env| -> Result<_, JavaError> {
            // SAFETY: the caller says that it is valid; a borrowed reference is never deleted here.
            let context = unsafe { env.as_cast_raw::<JObject<'_>>(&raw)? };
            let global = env.new_global_ref(&*context)?;
            Ok((global, JavaCaller::read_api_level(env)?))
        })?;
        Ok(AndroidDevice { vm, context, api_level })
    }

    /// Returns the device's API level.
    #[must_use]
    pub const fn api_level(&self) -> i32 {
        self.api_level
    }

    /// Reads manufacturer and model, separated by a space.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_manufacturer_and_model(&self) -> Result<String, JavaError> {
        self.call_java(|caller, _| {
            let mut words = Vec::new();
            for member in [MANUFACTURER, MODEL] {
                if let Some(value) = caller.call_or_read_static_if_available(member, &[])? {
                    words.extend(caller.read_string(member, value)?);
                }
            }
            Ok(words.join(" "))
        })
    }

    /// Reads the battery's state.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_battery(&self) -> Result<Battery, JavaError> {
        self.call_java(|caller, context| {
            let mut battery = Battery { percent: None, charging: false };
            let Some(manager) = system_service(caller, context, BATTERY_SERVICE)? else {
                return Ok(battery);
            };
            let which = [JValue::Int(BATTERY_PROPERTY_CAPACITY)];
            if let Some(value) =
                caller.call_method_if_available(BATTERY_PROPERTY, &manager, &which)?
            {
                // A device that doesn't know the capacity returns the smallest integer.
                let percent = read_int(BATTERY_PROPERTY, value)?;
                battery.percent = u8::try_from(percent).ok().filter(|percent| *percent <= 100);
            }
            if let Some(value) = caller.call_method_if_available(IS_CHARGING, &manager, &[])? {
                battery.charging = read_bool(IS_CHARGING, value)?;
            }
            Ok(battery)
        })
    }

    /// Reads the thermal status and headroom.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_thermal(&self) -> Result<ThermalReading, JavaError> {
        self.call_java(|caller, context| {
            let mut reading = ThermalReading { status: ThermalStatus::None, headroom: None };
            let Some(manager) = system_service(caller, context, POWER_SERVICE)? else {
                return Ok(reading);
            };
            if let Some(value) = caller.call_method_if_available(THERMAL_STATUS, &manager, &[])? {
                reading.status = ThermalStatus::from_number(read_int(THERMAL_STATUS, value)?);
            }
            let when = [JValue::Int(FORECAST_SECONDS)];
            if let Some(value) =
                caller.call_method_if_available(THERMAL_HEADROOM, &manager, &when)?
            {
                reading.headroom =
                    Some(read_float(THERMAL_HEADROOM, value)?).filter(|it| it.is_finite());
            }
            Ok(reading)
        })
    }

    /// Finds the folder for saved files: the external one, which a computer reads over USB, or, if there is
    /// none, the internal one.
    ///
    /// # Errors
    /// A call into Java that failed, or neither folder exists.
    pub fn find_storage_folder(&self) -> Result<PathBuf, JavaError> {
        self.call_java(|caller, context| {
            let own = JObject::null();
            let shared = caller.call_object_method_if_available(
                EXTERNAL_FILES_DIR,
                context,
                &[JValue::Object(&own)],
            )?;
            let folder = match shared {
                Some(folder) => Some(folder),
                None => caller.call_object_method_if_available(FILES_DIR, context, &[])?,
            };
            let folder = folder.ok_or_else(|| JavaError::null(FILES_DIR))?;
            read_path(caller, &folder)
        })
    }

    /// Finds the internal folder for secrets, which no other app and no computer can read.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn find_private_folder(&self) -> Result<PathBuf, JavaError> {
        self.call_java(|caller, context| {
            let folder = caller.call_object_method(FILES_DIR, context, &[])?;
            read_path(caller, &folder)
        })
    }

    /// Reads how many times the device has booted since it was set up; `None` if it doesn't count.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_boot_count(&self) -> Result<Option<u32>, JavaError> {
        self.call_java(|caller, context| {
            let Some(resolver) =
                caller.call_object_method_if_available(CONTENT_RESOLVER, context, &[])?
            else {
                return Ok(None);
            };
            let name = caller.new_string(BOOT_COUNT)?;
            let arguments = [JValue::Object(&resolver), JValue::Object(&name), JValue::Int(-1)];
            let value = caller.call_or_read_static_if_available(GLOBAL_INT, &arguments)?;
            let count = value.map(|value| read_int(GLOBAL_INT, value)).transpose()?;
            Ok(count.and_then(|count| u32::try_from(count).ok()))
        })
    }

    /// Returns `true` if the active network has reached the internet (`NET_CAPABILITY_VALIDATED`).
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn is_online(&self) -> Result<bool, JavaError> {
        self.call_java(|caller, context| {
            let Some(manager) = system_service(caller, context, CONNECTIVITY_SERVICE)? else {
                return Ok(false);
            };
            let Some(network) =
                caller.call_object_method_if_available(ACTIVE_NETWORK, &manager, &[])?
            else {
                return Ok(false);
            };
            let network = [JValue::Object(&network)];
            let Some(can) =
                caller.call_object_method_if_available(CAPABILITIES, &manager, &network)?
            else {
                return Ok(false);
            };
            let what = [JValue::Int(NET_CAPABILITY_VALIDATED)];
            let value = caller.call_method_if_available(HAS_CAPABILITY, &can, &what)?;
            value.map_or(Ok(false), |value| read_bool(HAS_CAPABILITY, value))
        })
    }

    /// Reads `ANDROID_ID`, the device's identifier for this app, which lasts until a factory reset, even if
    /// the app's data are deleted. Returns `None` if there is no such identifier.
    ///
    /// # Errors
    /// A call into Java that failed.
    pub fn read_android_id(&self) -> Result<Option<String>, JavaError> {
        self.call_java(|caller, context| {
            let Some(resolver) =
                caller.call_object_method_if_available(CONTENT_RESOLVER, context, &[])?
            else {
                return Ok(None);
            };
            let name = caller.new_string(ANDROID_ID)?;
            let arguments = [JValue::Object(&resolver), JValue::Object(&name)];
            let id = caller.call_or_read_static_if_available(SECURE_STRING, &arguments)?;
            let id = id.map(|id| caller.read_string(SECURE_STRING, id)).transpose()?.flatten();
            Ok(id.filter(|id| !id.is_empty()))
        })
    }

    /// Returns a function that creates HTTPS callers for booths, on any thread: see [`HttpsCaller::new`].
    pub fn booth_connector(&self) -> impl Fn(&str, &[u8]) -> HttpsCaller + Send + use<> {
        let vm = self.vm.clone();
        move |url, ca| HttpsCaller::new(vm.clone(), url, ca)
    }

    /// Creates a link to a booth, which isn't connected yet. The network's internet access isn't checked: a
    /// booth's network needs none.
    #[must_use]
    pub fn open_booth_link(&self, address: &BoothAddress, times: LinkTimes) -> ThreadedLink {
        let [of_puts, of_heartbeats] =
            [(); 2].map(|()| HttpsCaller::new(self.vm.clone(), &address.url, &address.ca));
        ThreadedLink::start(address.token, times, of_puts, of_heartbeats)
    }

    /// Queries these columns of the content provider at a `content://` address. Returns at most [`MAX_ROWS`]
    /// rows, and none if there is no such provider.
    ///
    /// # Errors
    /// A call into Java that failed, for instance for a refused permission.
    pub fn query_first_content_rows(
        &self,
        address: &str,
        columns: &[&str],
    ) -> Result<Vec<ContentRow>, JavaError> {
        self.call_java(|caller, context| {
            let Some(resolver) =
                caller.call_object_method_if_available(CONTENT_RESOLVER, context, &[])?
            else {
                return Ok(Vec::new());
            };
            let text = caller.new_string(address)?;
            let address =
                caller.call_or_read_static_if_available(PARSE_URI, &[JValue::Object(&text)])?;
            let Some(address) = address.and_then(|address| address.into_object().ok()) else {
                return Ok(Vec::new());
            };
            let (names, null) = (caller.new_string_array(columns)?, JObject::null());
            let arguments = [&address, &names, &null, &null, &null].map(JValue::Object);
            let Some(cursor) =
                caller.call_object_method_if_available(QUERY, &resolver, &arguments)?
            else {
                return Ok(Vec::new());
            };
            let rows = read_first_rows(caller, &cursor, columns);
            caller.call_method_if_available(CLOSE, &cursor, &[])?;
            rows
        })
    }

    /// Attaches the calling thread to the Java VM and runs `body` there.
    fn call_java<T>(
        &self,
        body: impl FnOnce(&mut JavaCaller<'_, '_>, &JObject<'_>) -> Result<T, JavaError>,
    ) -> Result<T, JavaError> {
        let inside = |env: &mut Env<'_>| {
            body(&mut JavaCaller::new(env, self.api_level), self.context.as_obj())
        };
        self.vm.attach_current_thread(inside)
    }
}

/// Reads the absolute path of a Java file.
fn read_path(caller: &mut JavaCaller<'_, '_>, file: &JObject<'_>) -> Result<PathBuf, JavaError> {
    let path = caller.call_method_if_available(ABSOLUTE_PATH, file, &[])?;
    let path = path.map(|path| caller.read_string(ABSOLUTE_PATH, path)).transpose()?.flatten();
    path.map(PathBuf::from).ok_or_else(|| JavaError::null(ABSOLUTE_PATH))
}

/// Finds a system service by its name; `None` if the device lacks it.
fn system_service<'local>(
    caller: &mut JavaCaller<'_, 'local>,
    context: &JObject<'_>,
    name: &str,
) -> Result<Option<JObject<'local>>, JavaError> {
    let name = caller.new_string(name)?;
    caller.call_object_method_if_available(SYSTEM_SERVICE, context, &[JValue::Object(&name)])
}

/// Reads the rows of a query's result, from its cursor.
fn read_first_rows(
    caller: &mut JavaCaller<'_, '_>,
    cursor: &JObject<'_>,
    columns: &[&str],
) -> Result<Vec<ContentRow>, JavaError> {
    let mut places = Vec::new();
    for column in columns {
        let name = caller.new_string(column)?;
        let place =
            caller.call_method_if_available(COLUMN_INDEX, cursor, &[JValue::Object(&name)])?;
        places.push(place.map_or(Ok(-1), |place| read_int(COLUMN_INDEX, place))?);
    }
    let mut rows = Vec::new();
    while rows.len() < MAX_ROWS {
        let moved = caller.call_method_if_available(MOVE_TO_NEXT, cursor, &[])?;
        if !moved.map_or(Ok(false), |value| read_bool(MOVE_TO_NEXT, value))? {
            break;
        }
        let mut row = vec![None; columns.len()];
        for (text, place) in row.iter_mut().zip(&places).filter(|(_, place)| **place >= 0) {
            if let Some(value) =
                caller.call_method_if_available(STRING, cursor, &[JValue::Int(*place)])?
            {
                *text = caller.read_string(STRING, value)?;
            }
        }
        rows.push(row);
    }
    Ok(rows)
}
