/* A Java machine without Java: every object is a name, every class is there, every method answers as its type and its
   name suggest, and none throws. */
#include <jni.h>

static const char *java_folder;

struct object {
  const char *name;
};

struct member {
  const char *name, *signature;
};

static void *java_object(const char *name) {
  struct object *made = malloc(sizeof *made);
  made->name = strdup(name);
  return made;
}

static void *find_class(JNIEnv *env, const char *name) { (void)env; return java_object(name); }
static void *same(JNIEnv *env, void *object) { (void)env; return object; }
static void *class_of(JNIEnv *env, void *object) { (void)env, (void)object; return java_object("java/lang/Class"); }
static void none(JNIEnv *env, void *object) { (void)env, (void)object; }
static jint zero(JNIEnv *env) { (void)env; return 0; }
static jint version(JNIEnv *env) { (void)env; return JNI_VERSION_1_6; }
static jboolean no(JNIEnv *env) { (void)env; return JNI_FALSE; }
static jboolean yes(JNIEnv *env, void *object, void *class) { (void)env, (void)object, (void)class; return JNI_TRUE; }
static jboolean is_same(JNIEnv *env, void *one, void *other) { (void)env; return one == other; }
static void *no_throwable(JNIEnv *env) { (void)env; return NULL; }
static jint reference_type(JNIEnv *env, void *object) { (void)env; return object ? JNIGlobalRefType : JNIInvalidRefType; }
static void *pop_frame(JNIEnv *env, void *result) { (void)env; return result; }

static void *find_member(JNIEnv *env, void *class, const char *name, const char *signature) {
  (void)env, (void)class;
  struct member *made = malloc(sizeof *made);
  *made = (struct member){strdup(name), strdup(signature)};
  return made;
}

static const char *const missing[] = {"getSystemService", "query", "getBundle", "getExtras", "getString", "getCause"};

static void *call_object(JNIEnv *env, void *object, const struct member *member, const jvalue *arguments) {
  (void)env, (void)object, (void)arguments;
  for (size_t i = 0; i < sizeof missing / sizeof *missing; i++)
    if (!strcmp(member->name, missing[i])) return NULL;
  if (!strcmp(member->name, "getAbsolutePath")) return java_object(java_folder);
  return java_object(member->name);
}

static jboolean call_boolean(JNIEnv *env, void *object, void *member, const jvalue *arguments) {
  (void)env, (void)object, (void)member, (void)arguments;
  return JNI_FALSE;
}

static jint call_int(JNIEnv *env, void *object, const struct member *member, const jvalue *arguments) {
  (void)env, (void)object, (void)member, (void)arguments;
  return 7;
}

static void call_void(JNIEnv *env, void *object, void *member, const jvalue *arguments) {
  (void)env, (void)object, (void)member, (void)arguments;
}

static jint get_int(JNIEnv *env, void *class, const struct member *member) {
  (void)env, (void)class;
  return strcmp(member->name, "SDK_INT") ? 0 : 32;
}

static void *get_object(JNIEnv *env, void *class, const struct member *member) {
  (void)env, (void)class;
  return java_object(member->name);
}

static void *new_string(JNIEnv *env, const char *text) { (void)env; return java_object(text); }
static void *new_array(JNIEnv *env, jsize length, void *class, void *first) {
  (void)env, (void)length, (void)class, (void)first;
  return java_object("array");
}
static void set_element(JNIEnv *env, void *array, jsize at, void *value) { (void)env, (void)array, (void)at, (void)value; }
static jsize string_length(JNIEnv *env, const struct object *text) { (void)env; return strlen(text->name); }
static const char *string_chars(JNIEnv *env, const struct object *text, jboolean *is_copy) {
  (void)env;
  if (is_copy) *is_copy = JNI_FALSE;
  return text->name;
}
static void release_chars(JNIEnv *env, void *text, const char *chars) { (void)env, (void)text, (void)chars; }
static jint get_vm(JNIEnv *env, JavaVM **vm);

/* Any other function of the table. */
static void not_there(void) {
  fprintf(stderr, "a function of JNI that this machine lacks\n");
  __builtin_trap();
}

static struct JNINativeInterface_ functions;
static const struct JNINativeInterface_ *the_env = &functions;
static __thread int is_attached;

static jint attach(JavaVM *vm, void **env, void *arguments) {
  (void)vm, (void)arguments;
  is_attached = 1;
  *env = &the_env;
  return JNI_OK;
}
static jint detach(JavaVM *vm) { (void)vm; is_attached = 0; return JNI_OK; }
static jint get_env(JavaVM *vm, void **env, jint wanted) {
  (void)vm, (void)wanted;
  *env = is_attached ? (void *)&the_env : NULL;
  return is_attached ? JNI_OK : JNI_EDETACHED;
}
static jint destroy_vm(JavaVM *vm) { (void)vm; return JNI_OK; }

static const struct JNIInvokeInterface_ invocation = {
    .DestroyJavaVM = destroy_vm,
    .AttachCurrentThread = attach,
    .DetachCurrentThread = detach,
    .GetEnv = get_env,
    .AttachCurrentThreadAsDaemon = attach,
};
static const struct JNIInvokeInterface_ *the_vm = &invocation;

static jint get_vm(JNIEnv *env, JavaVM **vm) {
  (void)env;
  *vm = (JavaVM *)&the_vm;
  return JNI_OK;
}

static void *java_vm(void) { return &the_vm; }

/* The environment of this thread, which is attached from now on. */
static void *java_env(void) {
  void **all = (void **)&functions;
  is_attached = 1;
  if (functions.GetVersion) return &the_env;
  for (size_t i = 4; i < sizeof functions / sizeof *all; i++) all[i] = not_there;
  functions.GetVersion = (void *)version;
  functions.FindClass = (void *)find_class;
  functions.GetObjectClass = (void *)class_of;
  functions.GetSuperclass = (void *)class_of;
  functions.IsInstanceOf = (void *)yes;
  functions.IsAssignableFrom = (void *)yes;
  functions.IsSameObject = (void *)is_same;
  functions.GetObjectRefType = (void *)reference_type;
  functions.NewGlobalRef = functions.NewLocalRef = functions.NewWeakGlobalRef = (void *)same;
  functions.DeleteGlobalRef = functions.DeleteLocalRef = functions.DeleteWeakGlobalRef = (void *)none;
  functions.EnsureLocalCapacity = functions.PushLocalFrame = (void *)zero;
  functions.PopLocalFrame = (void *)pop_frame;
  functions.ExceptionCheck = (void *)no;
  functions.ExceptionOccurred = (void *)no_throwable;
  functions.ExceptionClear = functions.ExceptionDescribe = (void *)none;
  functions.GetMethodID = functions.GetStaticMethodID = (void *)find_member;
  functions.GetFieldID = functions.GetStaticFieldID = (void *)find_member;
  functions.CallObjectMethodA = functions.CallStaticObjectMethodA = (void *)call_object;
  functions.CallBooleanMethodA = functions.CallStaticBooleanMethodA = (void *)call_boolean;
  functions.CallIntMethodA = functions.CallStaticIntMethodA = (void *)call_int;
  functions.CallVoidMethodA = functions.CallStaticVoidMethodA = (void *)call_void;
  functions.GetStaticIntField = (void *)get_int;
  functions.GetStaticObjectField = (void *)get_object;
  functions.NewStringUTF = (void *)new_string;
  functions.GetStringUTFLength = functions.GetStringLength = (void *)string_length;
  functions.GetStringUTFChars = (void *)string_chars;
  functions.ReleaseStringUTFChars = (void *)release_chars;
  functions.NewObjectArray = (void *)new_array;
  functions.SetObjectArrayElement = (void *)set_element;
  functions.GetJavaVM = get_vm;
  return &the_env;
}
