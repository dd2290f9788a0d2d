/* A library with the functions of libasound that are called, and a device that takes frames as fast as a real one.
   What it is asked for is checked against ALSA's headers; `wrong` counts what isn't as they say. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int opened, closed, wrong, written, recovered, open_failures;
float loudest;

static char device;

#ifndef FAIL_OPEN
#define FAIL_OPEN 0
#endif

int snd_pcm_open(void **pcm, const char *name, int stream, int mode) {
  wrong += strcmp(name, "default") != 0 || stream != 0 || mode != 0;
  if (open_failures < FAIL_OPEN) {
    open_failures++;
    return -2;
  }
  opened++;
  *pcm = &device;
  return 0;
}

int snd_pcm_set_params(void *pcm, int format, int access, unsigned channels, unsigned rate, int resample,
                       unsigned latency) {
  wrong += pcm != &device || format != 14 || access != 3 || channels != 2 || rate != 48000 || resample != 1;
  wrong += latency < 10000 || latency > 30000;
  return 0;
}

#ifndef LACKS_WRITE
static int calls;

long snd_pcm_writei(void *pcm, const float *frames, unsigned long count) {
  wrong += pcm != &device || opened - closed != 1;
  calls++;
#ifdef UNDERRUNS
  /* EPIPE, until it is recovered. */
  if (calls % 5 == 0) return -32;
#endif
#ifdef BREAKS
  if (calls == 20) return -19;
#endif
#ifdef TAKES_LITTLE
  /* The rest is offered again. */
  static const float *rest;
  static unsigned long left;
  wrong += left != 0 && (frames != rest || count != left);
  unsigned long offered = count;
  if (count > 100) count = 100;
  left = offered - count;
  rest = frames + 2 * count;
#endif
  for (unsigned long i = 0; i < 2 * count; i++) {
    float sample = frames[i] < 0 ? -frames[i] : frames[i];
    if (sample > loudest) loudest = sample;
  }
#ifdef TELLS
  /* To who can't look into this process: a file for the first sound that goes on. A tool that is taken clicks. */
  static int loud, told;
  for (unsigned long i = 0; i < 2 * count; i++) loud += frames[i] > 0.01f || frames[i] < -0.01f;
  if (loud > 8000 && !told++) {
    FILE *file = fopen(getenv("PAROS_MOCK_HEARD"), "w");
    if (file) fprintf(file, "%d wrong\n", wrong), fclose(file);
  }
#endif
  written += count;
  usleep(count * 1000 / 48);
  return count;
}
#endif

int snd_pcm_recover(void *pcm, int error, int silent) {
  wrong += pcm != &device || silent != 1;
  recovered++;
  return error == -32 ? 0 : error;
}

int snd_pcm_close(void *pcm) {
  wrong += pcm != &device;
  closed++;
  return 0;
}

const char *snd_strerror(int error) { return error == -2 ? "No such file or directory" : "No such device"; }

int snd_lib_error_set_handler(void (*handler)(const char *, int, const char *, int, const char *, ...)) {
  handler("conf.c", 1, "open", 2, "%s: no card", "default");
  return 0;
}
