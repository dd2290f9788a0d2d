//! Every member of Android's Java classes that the shell uses: nothing else is called by name.

/// What kind of member it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// A method of an object.
    Method,
    /// A method of the class.
    StaticMethod,
    /// A field of the class.
    StaticField,
}

/// A method or a field of a Java class.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Member {
    /// The class, with slashes.
    pub class: &'static str,
    /// Its name there.
    pub name: &'static str,
    /// Types as the JVM writes them.
    pub signature: &'static str,
    /// What kind of member it is.
    pub kind: Kind,
    /// The first API level that has it.
    pub since: i32,
    /// Its page below <https://developer.android.com/reference/>.
    pub source: &'static str,
}

macro_rules! members {
    ($($(#[$doc:meta])* $constant:ident = $kind:ident $class:literal $name:literal $signature:literal
        since $since:literal in $source:literal;)*) => {
        $($(#[$doc])* pub const $constant: Member = Member {
            class: $class,
            name: $name,
            signature: $signature,
            kind: Kind::$kind,
            since: $since,
            source: $source,
        };)*

        /// All of them.
        pub const ALL: &[Member] = &[$($constant),*];
    };
}

members! {
    /// The API level of the device.
    SDK_INT = StaticField "android/os/Build$VERSION" "SDK_INT" "I"
        since 4 in "android/os/Build.VERSION#SDK_INT";
    /// Who made the device.
    MANUFACTURER = StaticField "android/os/Build" "MANUFACTURER" "Ljava/lang/String;"
        since 4 in "android/os/Build#MANUFACTURER";
    /// What the device is sold as.
    MODEL = StaticField "android/os/Build" "MODEL" "Ljava/lang/String;"
        since 1 in "android/os/Build#MODEL";
    /// A system service by its name.
    SYSTEM_SERVICE = Method "android/content/Context" "getSystemService" "(Ljava/lang/String;)Ljava/lang/Object;"
        since 1 in "android/content/Context#getSystemService(java.lang.String)";
    /// The app's own folder, which nobody else reads.
    FILES_DIR = Method "android/content/Context" "getFilesDir" "()Ljava/io/File;"
        since 1 in "android/content/Context#getFilesDir()";
    /// The app's folder that is seen over USB. Null while it is not mounted.
    EXTERNAL_FILES_DIR = Method "android/content/Context" "getExternalFilesDir" "(Ljava/lang/String;)Ljava/io/File;"
        since 8 in "android/content/Context#getExternalFilesDir(java.lang.String)";
    /// What answers queries of other apps' data.
    CONTENT_RESOLVER = Method "android/content/Context" "getContentResolver" "()Landroid/content/ContentResolver;"
        since 1 in "android/content/Context#getContentResolver()";
    /// A file's whole path.
    ABSOLUTE_PATH = Method "java/io/File" "getAbsolutePath" "()Ljava/lang/String;"
        since 1 in "java/io/File#getAbsolutePath()";
    /// A number that the battery tells.
    BATTERY_PROPERTY = Method "android/os/BatteryManager" "getIntProperty" "(I)I"
        since 21 in "android/os/BatteryManager#getIntProperty(int)";
    /// Whether the battery is being charged.
    IS_CHARGING = Method "android/os/BatteryManager" "isCharging" "()Z"
        since 23 in "android/os/BatteryManager#isCharging()";
    /// How hot the device is, in seven steps.
    THERMAL_STATUS = Method "android/os/PowerManager" "getCurrentThermalStatus" "()I"
        since 29 in "android/os/PowerManager#getCurrentThermalStatus()";
    /// How hot it will be in some seconds, 1 being where it throttles. NaN if that is not known.
    THERMAL_HEADROOM = Method "android/os/PowerManager" "getThermalHeadroom" "(I)F"
        since 30 in "android/os/PowerManager#getThermalHeadroom(int)";
    /// The network that is used, or null.
    ACTIVE_NETWORK = Method "android/net/ConnectivityManager" "getActiveNetwork" "()Landroid/net/Network;"
        since 23 in "android/net/ConnectivityManager#getActiveNetwork()";
    /// What a network can do, or null if it is gone.
    CAPABILITIES = Method "android/net/ConnectivityManager" "getNetworkCapabilities" "(Landroid/net/Network;)Landroid/net/NetworkCapabilities;"
        since 21 in "android/net/ConnectivityManager#getNetworkCapabilities(android.net.Network)";
    /// Whether a network can do one thing.
    HAS_CAPABILITY = Method "android/net/NetworkCapabilities" "hasCapability" "(I)Z"
        since 21 in "android/net/NetworkCapabilities#hasCapability(int)";
    /// An address from its text.
    PARSE_URI = StaticMethod "android/net/Uri" "parse" "(Ljava/lang/String;)Landroid/net/Uri;"
        since 1 in "android/net/Uri#parse(java.lang.String)";
    /// Asks another app for some columns of a table; null if nobody answers.
    QUERY = Method "android/content/ContentResolver" "query" "(Landroid/net/Uri;[Ljava/lang/String;Ljava/lang/String;[Ljava/lang/String;Ljava/lang/String;)Landroid/database/Cursor;"
        since 1 in "android/content/ContentResolver#query(android.net.Uri,%20java.lang.String[],%20java.lang.String,%20java.lang.String[],%20java.lang.String)";
    /// Goes to an answer's next row, the first at first; false if there is none.
    MOVE_TO_NEXT = Method "android/database/Cursor" "moveToNext" "()Z"
        since 1 in "android/database/Cursor#moveToNext()";
    /// The number of a column, -1 if there is none of that name.
    COLUMN_INDEX = Method "android/database/Cursor" "getColumnIndex" "(Ljava/lang/String;)I"
        since 1 in "android/database/Cursor#getColumnIndex(java.lang.String)";
    /// The text in a column of the row.
    STRING = Method "android/database/Cursor" "getString" "(I)Ljava/lang/String;"
        since 1 in "android/database/Cursor#getString(int)";
    /// Ends an answer.
    CLOSE = Method "android/database/Cursor" "close" "()V"
        since 1 in "android/database/Cursor#close()";
}
