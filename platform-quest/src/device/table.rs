//! The table of all members of Android's Java classes that the shell calls, with signature, API level and
//! source. No other member is called by name.

/// The kind of a Java member.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MemberKind {
    /// A method of an object.
    Method,
    /// A method of the class.
    StaticMethod,
    /// A constructor.
    Constructor,
    /// A field of the class.
    StaticField,
}

/// A method or a field of a Java class.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct JavaMember {
    /// The class's binary name, with slashes.
    pub class: &'static str,
    /// The member's name; `<init>` for a constructor.
    pub name: &'static str,
    /// The type signature (JNI specification, "Type Signatures").
    pub signature: &'static str,
    /// Method or field, of an object or of the class.
    pub kind: MemberKind,
    /// The first API level that has it.
    pub since: i32,
    /// The member's page below <https://developer.android.com/reference/>.
    pub source: &'static str,
}

macro_rules! members {
    ($($(#[$doc:meta])* $constant:ident = $kind:ident $class:literal $name:literal $signature:literal
        since $since:literal in $source:literal;)*) => {
        $($(#[$doc])* pub const $constant: JavaMember = JavaMember {
            class: $class,
            name: $name,
            signature: $signature,
            kind: MemberKind::$kind,
            since: $since,
            source: $source,
        };)*

        /// All members.
        pub const ALL_MEMBERS: &[JavaMember] = &[$($constant),*];
    };
}

members! {
    /// The API level of the device.
    SDK_INT = StaticField "android/os/Build$VERSION" "SDK_INT" "I"
        since 4 in "android/os/Build.VERSION#SDK_INT";
    /// The device's manufacturer.
    MANUFACTURER = StaticField "android/os/Build" "MANUFACTURER" "Ljava/lang/String;"
        since 4 in "android/os/Build#MANUFACTURER";
    /// The device's model, as users know it.
    MODEL = StaticField "android/os/Build" "MODEL" "Ljava/lang/String;"
        since 1 in "android/os/Build#MODEL";
    /// A system service by its name.
    SYSTEM_SERVICE = Method "android/content/Context" "getSystemService" "(Ljava/lang/String;)Ljava/lang/Object;"
        since 1 in "android/content/Context#getSystemService(java.lang.String)";
    /// The app's internal folder, which no other app can read.
    FILES_DIR = Method "android/content/Context" "getFilesDir" "()Ljava/io/File;"
        since 1 in "android/content/Context#getFilesDir()";
    /// The app's external folder, which a computer reads over USB. Null while it is not mounted.
    EXTERNAL_FILES_DIR = Method "android/content/Context" "getExternalFilesDir" "(Ljava/lang/String;)Ljava/io/File;"
        since 8 in "android/content/Context#getExternalFilesDir(java.lang.String)";
    /// The resolver, which sends queries to content providers.
    CONTENT_RESOLVER = Method "android/content/Context" "getContentResolver" "()Landroid/content/ContentResolver;"
        since 1 in "android/content/Context#getContentResolver()";
    /// An integer setting of the whole device, or the given default if it is unset.
    GLOBAL_INT = StaticMethod "android/provider/Settings$Global" "getInt" "(Landroid/content/ContentResolver;Ljava/lang/String;I)I"
        since 17 in "android/provider/Settings.Global#getInt(android.content.ContentResolver,%20java.lang.String,%20int)";
    /// A string setting whose value differs for each app: `ANDROID_ID`.
    SECURE_STRING = StaticMethod "android/provider/Settings$Secure" "getString" "(Landroid/content/ContentResolver;Ljava/lang/String;)Ljava/lang/String;"
        since 3 in "android/provider/Settings.Secure#getString(android.content.ContentResolver,%20java.lang.String)";
    /// A file's absolute path.
    ABSOLUTE_PATH = Method "java/io/File" "getAbsolutePath" "()Ljava/lang/String;"
        since 1 in "java/io/File#getAbsolutePath()";
    /// A property of the battery.
    BATTERY_PROPERTY = Method "android/os/BatteryManager" "getIntProperty" "(I)I"
        since 21 in "android/os/BatteryManager#getIntProperty(int)";
    /// `true` while the battery is charging.
    IS_CHARGING = Method "android/os/BatteryManager" "isCharging" "()Z"
        since 23 in "android/os/BatteryManager#isCharging()";
    /// The thermal status, 0 to 6.
    THERMAL_STATUS = Method "android/os/PowerManager" "getCurrentThermalStatus" "()I"
        since 29 in "android/os/PowerManager#getCurrentThermalStatus()";
    /// The forecast thermal headroom: 1 is where the device throttles. NaN if it is not known.
    THERMAL_HEADROOM = Method "android/os/PowerManager" "getThermalHeadroom" "(I)F"
        since 30 in "android/os/PowerManager#getThermalHeadroom(int)";
    /// The active network, or null.
    ACTIVE_NETWORK = Method "android/net/ConnectivityManager" "getActiveNetwork" "()Landroid/net/Network;"
        since 23 in "android/net/ConnectivityManager#getActiveNetwork()";
    /// A network's capabilities, or null if it is gone.
    CAPABILITIES = Method "android/net/ConnectivityManager" "getNetworkCapabilities" "(Landroid/net/Network;)Landroid/net/NetworkCapabilities;"
        since 21 in "android/net/ConnectivityManager#getNetworkCapabilities(android.net.Network)";
    /// `true` if a network has a capability.
    HAS_CAPABILITY = Method "android/net/NetworkCapabilities" "hasCapability" "(I)Z"
        since 21 in "android/net/NetworkCapabilities#hasCapability(int)";
    /// Parses a URI.
    PARSE_URI = StaticMethod "android/net/Uri" "parse" "(Ljava/lang/String;)Landroid/net/Uri;"
        since 1 in "android/net/Uri#parse(java.lang.String)";
    /// Queries columns of a content provider's table. Returns a cursor; null if there is no provider.
    QUERY = Method "android/content/ContentResolver" "query" "(Landroid/net/Uri;[Ljava/lang/String;Ljava/lang/String;[Ljava/lang/String;Ljava/lang/String;)Landroid/database/Cursor;"
        since 1 in "android/content/ContentResolver#query(android.net.Uri,%20java.lang.String[],%20java.lang.String,%20java.lang.String[],%20java.lang.String)";
    /// Moves a cursor to the next row, at first to the first one; false if there is none.
    MOVE_TO_NEXT = Method "android/database/Cursor" "moveToNext" "()Z"
        since 1 in "android/database/Cursor#moveToNext()";
    /// The index of a column by its name; -1 if there is none.
    COLUMN_INDEX = Method "android/database/Cursor" "getColumnIndex" "(Ljava/lang/String;)I"
        since 1 in "android/database/Cursor#getColumnIndex(java.lang.String)";
    /// The text in a column of the cursor's row.
    STRING = Method "android/database/Cursor" "getString" "(I)Ljava/lang/String;"
        since 1 in "android/database/Cursor#getString(int)";
    /// Closes a cursor.
    CLOSE = Method "android/database/Cursor" "close" "()V"
        since 1 in "android/database/Cursor#close()";
    /// The app's restrictions: its managed configuration, empty on an unmanaged device.
    RESTRICTIONS = Method "android/content/RestrictionsManager" "getApplicationRestrictions" "()Landroid/os/Bundle;"
        since 21 in "android/content/RestrictionsManager#getApplicationRestrictions()";
    /// A bundle's keys.
    KEY_SET = Method "android/os/BaseBundle" "keySet" "()Ljava/util/Set;"
        since 21 in "android/os/BaseBundle#keySet()";
    /// The value of a key in a bundle.
    BUNDLE_VALUE = Method "android/os/BaseBundle" "get" "(Ljava/lang/String;)Ljava/lang/Object;"
        since 21 in "android/os/BaseBundle#get(java.lang.String)";
    /// An iterator over a set.
    ITERATOR = Method "java/util/Set" "iterator" "()Ljava/util/Iterator;"
        since 1 in "java/util/Set#iterator()";
    /// `true` if an iterator has a next element.
    HAS_NEXT = Method "java/util/Iterator" "hasNext" "()Z"
        since 1 in "java/util/Iterator#hasNext()";
    /// An iterator's next element.
    NEXT = Method "java/util/Iterator" "next" "()Ljava/lang/Object;"
        since 1 in "java/util/Iterator#next()";
    /// An object as text: a number's digits, a boolean's name.
    TO_STRING = Method "java/lang/Object" "toString" "()Ljava/lang/String;"
        since 1 in "java/lang/Object#toString()";
    /// A URL.
    NEW_URL = Constructor "java/net/URL" "<init>" "(Ljava/lang/String;)V"
        since 1 in "java/net/URL#URL(java.lang.String)";
    /// A connection to a URL through a proxy. Nothing is sent yet.
    OPEN_CONNECTION = Method "java/net/URL" "openConnection" "(Ljava/net/Proxy;)Ljava/net/URLConnection;"
        since 1 in "java/net/URL#openConnection(java.net.Proxy)";
    /// No proxy.
    NO_PROXY = StaticField "java/net/Proxy" "NO_PROXY" "Ljava/net/Proxy;"
        since 1 in "java/net/Proxy#NO_PROXY";
    /// Sets the timeout for connecting, in milliseconds.
    SET_CONNECT_TIMEOUT = Method "java/net/URLConnection" "setConnectTimeout" "(I)V"
        since 1 in "java/net/URLConnection#setConnectTimeout(int)";
    /// Sets the timeout of each read, in milliseconds.
    SET_READ_TIMEOUT = Method "java/net/URLConnection" "setReadTimeout" "(I)V"
        since 1 in "java/net/URLConnection#setReadTimeout(int)";
    /// Sets whether a request has a body.
    SET_DO_OUTPUT = Method "java/net/URLConnection" "setDoOutput" "(Z)V"
        since 1 in "java/net/URLConnection#setDoOutput(boolean)";
    /// Sets whether a response may come from a cache.
    SET_USE_CACHES = Method "java/net/URLConnection" "setUseCaches" "(Z)V"
        since 1 in "java/net/URLConnection#setUseCaches(boolean)";
    /// Sets a header of a request.
    SET_REQUEST_PROPERTY = Method "java/net/URLConnection" "setRequestProperty" "(Ljava/lang/String;Ljava/lang/String;)V"
        since 1 in "java/net/URLConnection#setRequestProperty(java.lang.String,%20java.lang.String)";
    /// The stream to which a request's body is written.
    OUTPUT_STREAM = Method "java/net/URLConnection" "getOutputStream" "()Ljava/io/OutputStream;"
        since 1 in "java/net/URLConnection#getOutputStream()";
    /// A header of a response, or null.
    HEADER_FIELD = Method "java/net/URLConnection" "getHeaderField" "(Ljava/lang/String;)Ljava/lang/String;"
        since 1 in "java/net/URLConnection#getHeaderField(java.lang.String)";
    /// The stream from which a response's body is read.
    INPUT_STREAM = Method "java/net/URLConnection" "getInputStream" "()Ljava/io/InputStream;"
        since 1 in "java/net/URLConnection#getInputStream()";
    /// The stream from which the body of an error response is read, or null if it has none.
    ERROR_STREAM = Method "java/net/HttpURLConnection" "getErrorStream" "()Ljava/io/InputStream;"
        since 1 in "java/net/HttpURLConnection#getErrorStream()";
    /// Sets a request's method.
    SET_REQUEST_METHOD = Method "java/net/HttpURLConnection" "setRequestMethod" "(Ljava/lang/String;)V"
        since 1 in "java/net/HttpURLConnection#setRequestMethod(java.lang.String)";
    /// Sets whether redirects are followed.
    SET_FOLLOW_REDIRECTS = Method "java/net/HttpURLConnection" "setInstanceFollowRedirects" "(Z)V"
        since 1 in "java/net/HttpURLConnection#setInstanceFollowRedirects(boolean)";
    /// Sends the request if it isn't sent yet, and waits for the response's status; -1 if it isn't HTTP.
    RESPONSE_CODE = Method "java/net/HttpURLConnection" "getResponseCode" "()I"
        since 1 in "java/net/HttpURLConnection#getResponseCode()";
    /// Closes a connection, even during a transfer.
    DISCONNECT = Method "java/net/HttpURLConnection" "disconnect" "()V"
        since 1 in "java/net/HttpURLConnection#disconnect()";
    /// Sets the factory for a connection's sockets.
    SET_SOCKET_FACTORY = Method "javax/net/ssl/HttpsURLConnection" "setSSLSocketFactory" "(Ljavax/net/ssl/SSLSocketFactory;)V"
        since 1 in "javax/net/ssl/HttpsURLConnection#setSSLSocketFactory(javax.net.ssl.SSLSocketFactory)";
    /// Writes bytes.
    WRITE_BYTES = Method "java/io/OutputStream" "write" "([B)V"
        since 1 in "java/io/OutputStream#write(byte[])";
    /// Closes an output stream.
    CLOSE_OUTPUT = Method "java/io/OutputStream" "close" "()V"
        since 1 in "java/io/OutputStream#close()";
    /// Reads bytes into a part of an array. Returns their number, or -1 at the end.
    READ_BYTES = Method "java/io/InputStream" "read" "([BII)I"
        since 1 in "java/io/InputStream#read(byte[],%20int,%20int)";
    /// Closes an input stream.
    CLOSE_INPUT = Method "java/io/InputStream" "close" "()V"
        since 1 in "java/io/InputStream#close()";
    /// An input stream over an array of bytes.
    NEW_BYTES_INPUT = Constructor "java/io/ByteArrayInputStream" "<init>" "([B)V"
        since 1 in "java/io/ByteArrayInputStream#ByteArrayInputStream(byte[])";
    /// A parser of certificates of a given type.
    CERTIFICATE_FACTORY = StaticMethod "java/security/cert/CertificateFactory" "getInstance" "(Ljava/lang/String;)Ljava/security/cert/CertificateFactory;"
        since 1 in "java/security/cert/CertificateFactory#getInstance(java.lang.String)";
    /// Parses a certificate.
    READ_CERTIFICATE = Method "java/security/cert/CertificateFactory" "generateCertificate" "(Ljava/io/InputStream;)Ljava/security/cert/Certificate;"
        since 1 in "java/security/cert/CertificateFactory#generateCertificate(java.io.InputStream)";
    /// The type of key store that is always available.
    KEY_STORE_TYPE = StaticMethod "java/security/KeyStore" "getDefaultType" "()Ljava/lang/String;"
        since 1 in "java/security/KeyStore#getDefaultType()";
    /// A key store of a given type.
    KEY_STORE = StaticMethod "java/security/KeyStore" "getInstance" "(Ljava/lang/String;)Ljava/security/KeyStore;"
        since 1 in "java/security/KeyStore#getInstance(java.lang.String)";
    /// Loads a key store; null creates an empty one.
    LOAD_KEY_STORE = Method "java/security/KeyStore" "load" "(Ljava/io/InputStream;[C)V"
        since 1 in "java/security/KeyStore#load(java.io.InputStream,%20char[])";
    /// Adds a trusted certificate to a key store.
    SET_CERTIFICATE = Method "java/security/KeyStore" "setCertificateEntry" "(Ljava/lang/String;Ljava/security/cert/Certificate;)V"
        since 1 in "java/security/KeyStore#setCertificateEntry(java.lang.String,%20java.security.cert.Certificate)";
    /// The default algorithm for trust decisions.
    TRUST_ALGORITHM = StaticMethod "javax/net/ssl/TrustManagerFactory" "getDefaultAlgorithm" "()Ljava/lang/String;"
        since 1 in "javax/net/ssl/TrustManagerFactory#getDefaultAlgorithm()";
    /// A factory of trust managers.
    TRUST_FACTORY = StaticMethod "javax/net/ssl/TrustManagerFactory" "getInstance" "(Ljava/lang/String;)Ljavax/net/ssl/TrustManagerFactory;"
        since 1 in "javax/net/ssl/TrustManagerFactory#getInstance(java.lang.String)";
    /// Makes a factory trust only the certificates of a key store.
    INIT_TRUST_FACTORY = Method "javax/net/ssl/TrustManagerFactory" "init" "(Ljava/security/KeyStore;)V"
        since 1 in "javax/net/ssl/TrustManagerFactory#init(java.security.KeyStore)";
    /// The trust managers, which decide whether a certificate is trusted.
    TRUST_MANAGERS = Method "javax/net/ssl/TrustManagerFactory" "getTrustManagers" "()[Ljavax/net/ssl/TrustManager;"
        since 1 in "javax/net/ssl/TrustManagerFactory#getTrustManagers()";
    /// A TLS context.
    SSL_CONTEXT = StaticMethod "javax/net/ssl/SSLContext" "getInstance" "(Ljava/lang/String;)Ljavax/net/ssl/SSLContext;"
        since 1 in "javax/net/ssl/SSLContext#getInstance(java.lang.String)";
    /// Initialises a TLS context with keys, trust managers and a random source; null stands for the default.
    INIT_SSL_CONTEXT = Method "javax/net/ssl/SSLContext" "init" "([Ljavax/net/ssl/KeyManager;[Ljavax/net/ssl/TrustManager;Ljava/security/SecureRandom;)V"
        since 1 in "javax/net/ssl/SSLContext#init(javax.net.ssl.KeyManager[],%20javax.net.ssl.TrustManager[],%20java.security.SecureRandom)";
    /// The factory of TLS sockets.
    SOCKET_FACTORY = Method "javax/net/ssl/SSLContext" "getSocketFactory" "()Ljavax/net/ssl/SSLSocketFactory;"
        since 1 in "javax/net/ssl/SSLContext#getSocketFactory()";
}
