/* A library with the functions of libaaudio that are called, and a device that takes frames as fast as a real one.
   What it is asked for is checked against Android's headers; `wrong` counts what isn't as they say. */
#include <stdint.h>
#include <unistd.h>

int opened, closed, wrong, written, recovered, open_failures;
float loudest;

static int options, builders, started;
static char builder, stream;

#ifndef FAIL_OPEN
#define FAIL_OPEN 0
#endif

int32_t AAudio_createStreamBuilder(void **created) {
  builders++;
  options = 0;
  *created = &builder;
  return 0;
}

static void set(void *of, int32_t value, int32_t expected) {
  wrong += of != &builder || value != expected;
  options++;
}
void AAudioStreamBuilder_setSampleRate(void *of, int32_t value) { set(of, value, 48000); }
void AAudioStreamBuilder_setChannelCount(void *of, int32_t value) { set(of, value, 2); }
void AAudioStreamBuilder_setFormat(void *of, int32_t value) { set(of, value, 2); }
void AAudioStreamBuilder_setPerformanceMode(void *of, int32_t value) { set(of, value, 12); }

int32_t AAudioStreamBuilder_openStream(void *of, void **created) {
  wrong += of != &builder || options != 4;
  if (open_failures < FAIL_OPEN) {
    open_failures++;
    return -889;
  }
  opened++;
  started = 0;
  *created = &stream;
  return 0;
}

int32_t AAudioStreamBuilder_delete(void *of) {
  wrong += of != &builder;
  builders--;
  return 0;
}

int32_t AAudioStream_setBufferSizeInFrames(void *of, int32_t frames) {
  wrong += of != &stream || frames < 480 || frames > 1440;
  return frames;
}

int32_t AAudioStream_requestStart(void *of) {
  wrong += of != &stream || started;
  started = 1;
  return 0;
}

#ifndef LACKS_WRITE
static int calls;

int32_t AAudioStream_write(void *of, const float *frames, int32_t count, int64_t timeout) {
  wrong += of != &stream || !started || opened - closed != 1 || timeout < 100000000 || builders != 0;
  calls++;
#ifdef BREAKS
  /* AAUDIO_ERROR_DISCONNECTED */
  if (calls == 20) return -899;
#endif
#ifdef TAKES_LITTLE
  /* The rest is offered again. */
  static const float *rest;
  static int32_t left;
  wrong += left != 0 && (frames != rest || count != left);
  int32_t offered = count;
  if (count > 100) count = 100;
  left = offered - count;
  rest = frames + 2 * count;
#endif
#ifdef TAKES_NOTHING
  return 0;
#endif
  for (int32_t i = 0; i < 2 * count; i++) {
    float sample = frames[i] < 0 ? -frames[i] : frames[i];
    if (sample > loudest) loudest = sample;
  }
  written += count;
  usleep(count * 1000 / 48);
  return count;
}
#endif

int32_t AAudioStream_close(void *of) {
  wrong += of != &stream;
  closed++;
  return 0;
}

const char *AAudio_convertResultToText(int32_t result) {
  return result == -899 ? "AAUDIO_ERROR_DISCONNECTED" : "AAUDIO_ERROR_UNAVAILABLE";
}
