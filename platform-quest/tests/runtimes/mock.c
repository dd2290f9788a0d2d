/* An OpenXR runtime that has no headset. It counts its calls, and refuses what runtimes on headsets refuse: a
 * negotiation before the initialisation, and a second one of either; and where one of those would break off, as it is
 * asked for what no loader asks a runtime for, it counts that. What it exports is chosen when it is compiled:
 *
 *   EXPORTS   xrInitializeLoaderKHR is exported, and by xrGetInstanceProcAddr not to be had
 *   RETURNS   what the initialisation returns, else XR_SUCCESS
 *   LOADER    a loader's library: xrGetInstanceProcAddr is exported, and there is no negotiation
 */
#include <stdint.h>
#include <stddef.h>
#include <string.h>

enum {
    SUCCESS = 0,
    VALIDATION_FAILURE = -1,
    INITIALIZATION_FAILED = -6,
    FUNCTION_UNSUPPORTED = -7,
    INSTANCE_LOST = -13,
    LOADER_INIT_INFO_ANDROID = 1000089000,
};

#ifndef RETURNS
#define RETURNS SUCCESS
#endif

typedef void (*Function)(void);

struct init_info {
    int32_t type;
    const void *next;
    void *vm, *context;
};

struct extension {
    int32_t type;
    void *next;
    char name[128];
    uint32_t version;
};

struct request {
    int32_t type;
    uint32_t version;
    size_t size;
    uint32_t interface;
    uint64_t api;
    int32_t (*get_instance_proc_addr)(uint64_t, const char *, Function *);
};

/* Calls so far. */
int initialized, negotiated, created, strayed;

static int32_t initialize(const struct init_info *info)
{
    /* The tests' context. */
    if (info->type != LOADER_INIT_INFO_ANDROID || info->next || info->vm != (void *)16 || info->context != (void *)32)
        return VALIDATION_FAILURE;
    return ++initialized > 1 ? INITIALIZATION_FAILED : RETURNS;
}

static int32_t enumerate_extensions(const char *layer, uint32_t capacity, uint32_t *count, struct extension *all)
{
    (void)layer;
    *count = 1;
    if (capacity == 0)
        return SUCCESS;
    strcpy(all->name, "XR_KHR_vulkan_enable2");
    all->version = 1;
    return SUCCESS;
}

static int32_t create_instance(const void *info, uint64_t *instance)
{
    (void)info, (void)instance;
    created++;
    return INSTANCE_LOST;
}

#ifdef LOADER
#define get_instance_proc_addr xrGetInstanceProcAddr
#else
static
#endif
int32_t get_instance_proc_addr(uint64_t instance, const char *name, Function *function)
{
    *function = NULL;
#ifndef EXPORTS
    if (strcmp(name, "xrInitializeLoaderKHR") == 0)
        *function = (Function)initialize;
#endif
    if (strcmp(name, "xrEnumerateInstanceExtensionProperties") == 0)
        *function = (Function)enumerate_extensions;
    if (strcmp(name, "xrCreateInstance") == 0)
        *function = (Function)create_instance;
    if (*function)
        return SUCCESS;
    strayed += instance == 0;
    return FUNCTION_UNSUPPORTED;
}

#ifdef EXPORTS
int32_t xrInitializeLoaderKHR(const struct init_info *info)
{
    return initialize(info);
}
#endif

#ifndef LOADER
int32_t xrNegotiateLoaderRuntimeInterface(const void *loader, struct request *request)
{
    (void)loader;
#ifdef EXPORTS
    if (initialized == 0)
        return INITIALIZATION_FAILED;
#endif
    if (++negotiated > 1)
        return INITIALIZATION_FAILED;
    request->interface = 1;
    request->api = (uint64_t)1 << 48;
    request->get_instance_proc_addr = get_instance_proc_addr;
    return SUCCESS;
}
#endif
