/* Plays a trace on the Android library, for `replay`. */
#include <dlfcn.h>
#include <stdio.h>

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
