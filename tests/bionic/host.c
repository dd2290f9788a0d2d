/* Runs the Android library's replay on glibc, for `replay`. What bionic has under another name or
   with other numbers stands here, where the library finds it first. */
#include <dlfcn.h>
#include <errno.h>
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

int main(int count, char **arguments) {
  if (count != 4) {
    fprintf(stderr, "usage: host LIBRARY TRACE DIGESTS\n");
    return 2;
  }
  void *library = dlopen(arguments[1], RTLD_NOW);
  int (*replay)(const char *, const char *) = library ? dlsym(library, "paros_replay") : NULL;
  if (!replay) {
    fprintf(stderr, "%s\n", dlerror());
    return 1;
  }
  return replay(arguments[2], arguments[3]);
}
