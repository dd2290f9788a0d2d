/* Android's loopers and input queues, over poll(2). */
#include <stddef.h>

static FILE *stderr_of_host;

struct source {
  int fd, ident;
  void *data;
};

struct looper {
  pthread_mutex_t lock;
  int wake, count;
  struct source sources[8];
};

static __thread struct looper *own_looper;

struct looper *ALooper_prepare(int options) {
  (void)options;
  if (!own_looper) {
    own_looper = calloc(1, sizeof *own_looper);
    pthread_mutex_init(&own_looper->lock, NULL);
    own_looper->wake = eventfd(0, EFD_NONBLOCK);
  }
  return own_looper;
}

struct looper *ALooper_forThread(void) { return own_looper; }
/* They live as long as the process. */
void ALooper_acquire(struct looper *looper) { (void)looper; }
void ALooper_release(struct looper *looper) { (void)looper; }

void ALooper_wake(struct looper *looper) { eventfd_write(looper->wake, 1); }

int ALooper_removeFd(struct looper *looper, int fd) {
  pthread_mutex_lock(&looper->lock);
  for (int i = 0; i < looper->count; i++)
    if (looper->sources[i].fd == fd) looper->sources[i--] = looper->sources[--looper->count];
  pthread_mutex_unlock(&looper->lock);
  return 1;
}

int ALooper_addFd(struct looper *looper, int fd, int ident, int events, void *callback, void *data) {
  (void)events;
  /* Those of the Java thread's looper have callbacks; nothing runs it here. */
  if (callback) return 1;
  ALooper_removeFd(looper, fd);
  pthread_mutex_lock(&looper->lock);
  looper->sources[looper->count++] = (struct source){fd, ident, data};
  pthread_mutex_unlock(&looper->lock);
  ALooper_wake(looper);
  return 1;
}

int ALooper_pollOnce(int timeout, int *fd, int *events, void **data) {
  struct looper *looper = own_looper;
  struct pollfd polled[9];
  pthread_mutex_lock(&looper->lock);
  int count = looper->count;
  for (int i = 0; i < count; i++) polled[i] = (struct pollfd){looper->sources[i].fd, POLLIN, 0};
  polled[count] = (struct pollfd){looper->wake, POLLIN, 0};
  pthread_mutex_unlock(&looper->lock);
  int ready = poll(polled, count + 1, timeout);
  if (ready < 0) return -1; /* ALOOPER_POLL_WAKE: a signal */
  if (ready == 0) return -3; /* ALOOPER_POLL_TIMEOUT */
  for (int i = 0; i < count; i++) {
    if (!polled[i].revents) continue;
    *fd = polled[i].fd;
    *events = polled[i].revents;
    pthread_mutex_lock(&looper->lock);
    int ident = -1;
    for (int j = 0; j < looper->count; j++)
      if (looper->sources[j].fd == polled[i].fd) ident = looper->sources[j].ident, *data = looper->sources[j].data;
    pthread_mutex_unlock(&looper->lock);
    return ident;
  }
  eventfd_t times;
  eventfd_read(looper->wake, &times);
  return -1;
}

/* ---- input ---- */

#define AKEYCODE_VOLUME_UP 24

struct queue {
  int ready;
  struct looper *looper;
  atomic_int pending, finished, handled;
  int key;
};

static struct queue *queue_new(void) {
  struct queue *queue = calloc(1, sizeof *queue);
  queue->ready = eventfd(0, EFD_NONBLOCK);
  return queue;
}

static void queue_key(struct queue *queue, int key) {
  queue->key = key;
  atomic_store(&queue->pending, 1);
  eventfd_write(queue->ready, 1);
}

void AInputQueue_attachLooper(struct queue *queue, struct looper *looper, int ident, void *callback, void *data) {
  queue->looper = looper;
  ALooper_addFd(looper, queue->ready, ident, 1, callback, data);
}

void AInputQueue_detachLooper(struct queue *queue) {
  if (queue->looper) ALooper_removeFd(queue->looper, queue->ready);
  queue->looper = NULL;
}

int AInputQueue_getEvent(struct queue *queue, void **event) {
  if (!atomic_exchange(&queue->pending, 0)) return -11; /* WOULD_BLOCK */
  eventfd_t times;
  eventfd_read(queue->ready, &times);
  *event = &queue->key;
  return 0;
}

int AInputQueue_preDispatchEvent(struct queue *queue, void *event) {
  (void)queue, (void)event;
  return 0;
}

void AInputQueue_finishEvent(struct queue *queue, void *event, int handled) {
  (void)event;
  atomic_store(&queue->handled, handled);
  atomic_store(&queue->finished, 1);
}

int AInputEvent_getType(const void *event) {
  (void)event;
  return 1; /* AINPUT_EVENT_TYPE_KEY */
}
