/* A loader in the package, whose first call of all takes as long as a slow driver: it is the host's. */
typedef int (*function)(void);

extern int host_answer_runtime_call(const char *name);

int xrInitializeLoaderKHR(const void *info) {
  (void)info;
  return 0;
}

static int enumerate_extensions(void) { return host_answer_runtime_call("xrEnumerateInstanceExtensionProperties"); }

static int refuse(void) { return -2; /* XR_ERROR_RUNTIME_FAILURE */ }

int xrGetInstanceProcAddr(void *instance, const char *name, function *found) {
  (void)instance;
  /* Not every loader has this one among its functions. */
  if (name[2] == 'I') {
    *found = 0;
    return -7; /* XR_ERROR_FUNCTION_UNSUPPORTED */
  }
  *found = name[2] == 'E' && name[11] == 'I' && name[19] == 'E' ? enumerate_extensions : refuse;
  return 0;
}
