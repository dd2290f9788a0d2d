/* What bionic has under another name, with other numbers or in another size than glibc. It stands in the program,
   where the library finds it first. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

int *__errno(void) { return &errno; }

/* No property is set. */
int __system_property_get(const char *name, char *value) {
  (void)name;
  *value = 0;
  return 0;
}

/* bionic's is POSIX's. */
extern int __xpg_strerror_r(int, char *, size_t);
int posix_strerror_r(int error, char *text, size_t length) __asm__("strerror_r");
int posix_strerror_r(int error, char *text, size_t length) { return __xpg_strerror_r(error, text, length); }

/* bionic's numbers: 39 and 40 are the page's size, 97 the processors. */
extern long __sysconf(int);
long sysconf(int name) {
  switch (name) {
    case 39:
    case 40:
      return getpagesize();
    case 97:
      return 1;
    default:
      fprintf(stderr, "sysconf(%d)\n", name);
      errno = EINVAL;
      return -1;
  }
}

/* bionic's pthread_attr_t is smaller than glibc's. Only the stack's size is asked for. */
struct bionic_attributes {
  size_t stack_size;
  char others[48];
};

int bionic_attr_init(void *attributes) __asm__("pthread_attr_init");
int bionic_attr_init(void *attributes) {
  memset(attributes, 0, sizeof(struct bionic_attributes));
  return 0;
}

int bionic_attr_destroy(void *attributes) __asm__("pthread_attr_destroy");
int bionic_attr_destroy(void *attributes) {
  (void)attributes;
  return 0;
}

int bionic_attr_setstacksize(void *attributes, size_t size) __asm__("pthread_attr_setstacksize");
int bionic_attr_setstacksize(void *attributes, size_t size) {
  ((struct bionic_attributes *)attributes)->stack_size = size;
  return 0;
}

int bionic_create(pthread_t *, const void *, void *(*)(void *), void *) __asm__("pthread_create");
int bionic_create(pthread_t *thread, const void *attributes, void *(*start)(void *), void *argument) {
  int (*init)(pthread_attr_t *) = dlsym(RTLD_NEXT, "pthread_attr_init");
  int (*resize)(pthread_attr_t *, size_t) = dlsym(RTLD_NEXT, "pthread_attr_setstacksize");
  int (*create)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *) = dlsym(RTLD_NEXT, "pthread_create");
  pthread_attr_t own;
  init(&own);
  if (attributes && ((const struct bionic_attributes *)attributes)->stack_size)
    resize(&own, ((const struct bionic_attributes *)attributes)->stack_size);
  return create(thread, &own, start, argument);
}
