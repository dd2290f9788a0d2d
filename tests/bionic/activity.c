/* An activity's life as Android's Java thread leads it, on the library and glibc: the callbacks, each timed, while the
   library's OpenXR runtime takes ten seconds for a call; a volume key; and a second activity in the process.
   usage: activity LIBRARY FOLDER. Writes lines `NAME MILLISECONDS` and what else a test wants to know. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include "java.h"
#include "looper.h"

#define BLOCK_SECONDS 10

static FILE *out;

static double now_ms(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * 1e3 + time.tv_nsec / 1e6;
}

/* ---- the runtime ---- */

static atomic_int runtime_calls, is_blocked;

int host_answer_runtime_call(const char *name) {
  (void)name;
  if (atomic_fetch_add(&runtime_calls, 1) == 0) {
    atomic_store(&is_blocked, 1);
    sleep(BLOCK_SECONDS);
    atomic_store(&is_blocked, 0);
  }
  return -2; /* XR_ERROR_RUNTIME_FAILURE */
}

/* ---- the activity, as android/native_activity.h has it ---- */

struct activity;

struct callbacks {
  void (*onStart)(struct activity *);
  void (*onResume)(struct activity *);
  void *(*onSaveInstanceState)(struct activity *, size_t *);
  void (*onPause)(struct activity *);
  void (*onStop)(struct activity *);
  void (*onDestroy)(struct activity *);
  void (*onWindowFocusChanged)(struct activity *, int);
  void (*onNativeWindowCreated)(struct activity *, void *);
  void (*onNativeWindowResized)(struct activity *, void *);
  void (*onNativeWindowRedrawNeeded)(struct activity *, void *);
  void (*onNativeWindowDestroyed)(struct activity *, void *);
  void (*onInputQueueCreated)(struct activity *, void *);
  void (*onInputQueueDestroyed)(struct activity *, void *);
  void (*onContentRectChanged)(struct activity *, const void *);
  void (*onConfigurationChanged)(struct activity *);
  void (*onLowMemory)(struct activity *);
};

struct activity {
  struct callbacks *callbacks;
  void *vm, *env, *clazz;
  const char *internal_path, *external_path;
  int sdk_version;
  void *instance, *assets;
  const char *obb_path;
  /* Whether the library wants it over: no part of Android's. */
  atomic_int is_finished;
};

void ANativeActivity_finish(struct activity *activity) { atomic_store(&activity->is_finished, 1); }
void ANativeActivity_setWindowFlags(struct activity *activity, unsigned add, unsigned remove) {
  (void)activity, (void)remove;
  fprintf(out, "window-flags %x\n", add);
}

void ANativeWindow_acquire(void *window) { (void)window; }
void ANativeWindow_release(void *window) { (void)window; }
void *AAssetManager_fromJava(void *env, void *manager) { (void)env; return manager; }

/* The package's assets are files of the folder that PAROS_ASSETS names. */
struct asset {
  long length;
  char bytes[];
};

void *AAssetManager_open(void *manager, const char *name, int mode) {
  (void)manager, (void)mode;
  char path[512];
  snprintf(path, sizeof path, "%s/%s", getenv("PAROS_ASSETS"), name);
  FILE *file = fopen(path, "rb");
  if (!file) return NULL;
  fseek(file, 0, SEEK_END);
  long length = ftell(file);
  struct asset *asset = malloc(sizeof *asset + length);
  asset->length = length;
  rewind(file);
  if (fread(asset->bytes, 1, length, file) != (size_t)length) abort();
  fclose(file);
  return asset;
}

long AAsset_getLength64(struct asset *asset) { return asset->length; }
const void *AAsset_getBuffer(struct asset *asset) { return asset->bytes; }
void AAsset_close(struct asset *asset) { free(asset); }

int __android_log_write(int priority, const char *tag, const char *text) {
  (void)priority;
  return fprintf(stderr_of_host, "%s: %s\n", tag, text);
}

/* Android's configuration, of which nothing is known. */
void *AConfiguration_new(void) { return calloc(1, 64); }
void AConfiguration_delete(void *configuration) { free(configuration); }
void AConfiguration_copy(void *to, void *from) { memcpy(to, from, 64); }
void AConfiguration_fromAssetManager(void *configuration, void *manager) { (void)configuration, (void)manager; }

/* ---- calls in time ---- */

#define TIME(name, call)                                   \
  do {                                                     \
    double begun = now_ms();                               \
    call;                                                  \
    fprintf(out, "%s %.1f\n", name, now_ms() - begun);     \
    fflush(out);                                           \
  } while (0)

static void (*on_create)(struct activity *, void *, size_t);
static int window;

static struct activity *create(const char *folder) {
  struct activity *made = calloc(1, sizeof *made);
  made->callbacks = calloc(1, sizeof *made->callbacks);
  made->vm = java_vm();
  made->env = java_env();
  made->clazz = java_object("android/app/NativeActivity");
  made->internal_path = made->external_path = made->obb_path = folder;
  made->sdk_version = 32;
  made->assets = java_object("assets");
  TIME("onCreate", on_create(made, NULL, 0));
  return made;
}

static void show(struct activity *activity, struct queue *queue) {
  struct callbacks *call = activity->callbacks;
  TIME("onStart", call->onStart(activity));
  TIME("onResume", call->onResume(activity));
  TIME("onInputQueueCreated", call->onInputQueueCreated(activity, queue));
  TIME("onNativeWindowCreated", call->onNativeWindowCreated(activity, &window));
  TIME("onWindowFocusChanged", call->onWindowFocusChanged(activity, 1));
}

static void hide(struct activity *activity, struct queue *queue) {
  struct callbacks *call = activity->callbacks;
  size_t length;
  TIME("onWindowFocusChanged", call->onWindowFocusChanged(activity, 0));
  TIME("onPause", call->onPause(activity));
  TIME("onSaveInstanceState", free(call->onSaveInstanceState(activity, &length)));
  TIME("onNativeWindowDestroyed", call->onNativeWindowDestroyed(activity, &window));
  TIME("onStop", call->onStop(activity));
  TIME("onInputQueueDestroyed", call->onInputQueueDestroyed(activity, queue));
}

static void destroy(struct activity *activity) {
  TIME("onDestroy", activity->callbacks->onDestroy(activity));
  /* As the framework does: whoever uses it from now on fails. */
  memset(activity->callbacks, 0xAA, sizeof *activity->callbacks);
  memset(activity, 0xAA, offsetof(struct activity, is_finished));
}

/* Presses a volume key, and tells how it came back. */
static void press_volume_key(struct queue *queue) {
  double begun = now_ms();
  queue_key(queue, AKEYCODE_VOLUME_UP);
  while (atomic_load(&queue->finished) == 0 && now_ms() - begun < 5000) usleep(1000);
  fprintf(out, "volume-key %.1f\n", now_ms() - begun);
  fprintf(out, "volume-key-finished %d handled %d\n", atomic_load(&queue->finished), atomic_load(&queue->handled));
}

static int wait_until(atomic_int *flag, int least, int seconds) {
  for (int i = 0; i < seconds * 100 && atomic_load(flag) < least; i++) usleep(10000);
  return atomic_load(flag) >= least;
}

int main(int count, char **arguments) {
  if (count != 3) {
    fprintf(stderr, "usage: activity LIBRARY FOLDER\n");
    return 2;
  }
  /* The library's own standard streams go to Android's log. */
  out = fdopen(dup(1), "w");
  stderr_of_host = fdopen(dup(2), "w");
  setvbuf(stderr_of_host, NULL, _IOLBF, 0);
  java_folder = arguments[2];
  void *library = dlopen(arguments[1], RTLD_NOW);
  on_create = library ? dlsym(library, "ANativeActivity_onCreate") : NULL;
  if (!on_create) {
    fprintf(stderr_of_host, "%s\n", dlerror());
    return 1;
  }
  ALooper_prepare(0);

  struct activity *first = create(arguments[2]);
  struct queue *queue = queue_new();
  show(first, queue);
  if (!wait_until(&is_blocked, 1, 300)) {
    fprintf(out, "the runtime was never called\n");
    return 1;
  }
  press_volume_key(queue);
  /* Taken off, put on and left, within one call of the runtime. */
  hide(first, queue);
  show(first, queue);
  TIME("onConfigurationChanged", first->callbacks->onConfigurationChanged(first));
  TIME("onLowMemory", first->callbacks->onLowMemory(first));
  hide(first, queue);
  destroy(first);
  struct activity *second = create(arguments[2]);
  struct queue *other = queue_new();
  show(second, other);
  fprintf(out, "blocked-still %d calls %d\n", atomic_load(&is_blocked), atomic_load(&runtime_calls));
  /* The second one has the runtime once the first one's call is over; both fail, as it does. */
  int ended = wait_until(&second->is_finished, 1, 120);
  fprintf(out, "second-finished %d calls %d\n", ended, atomic_load(&runtime_calls));
  hide(second, other);
  destroy(second);
  fflush(out);
  _exit(0);
}
