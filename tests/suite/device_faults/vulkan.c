// A Vulkan loader that stands before the real one and makes one kind of call fail, so that what a program does with a
// faulty device can be tested on any driver, in software too.
//
//   cc -shared -fPIC -o libvulkan.so.1 vulkan.c -ldl
//   LD_LIBRARY_PATH=. FAULT_VULKAN=/path/of/the/real/libvulkan.so.1 FAULT=wait:6 program
//
// FAULT is a kind and how many calls of that kind still succeed. Kinds: submit, alloc, device, pipeline fail in that call;
// wait reports a lost device and hang a timeout, once so many submissions were made. FAULT_POSE=1: the device says that it
// is a discrete card.
//
// Only numbers and places that the Vulkan specification fixes are used, so no header is needed.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { TIMEOUT = 2, OUT_OF_HOST_MEMORY = -1, OUT_OF_DEVICE_MEMORY = -2, INITIALIZATION_FAILED = -3, DEVICE_LOST = -4 };
enum { DISCRETE_GPU = 2 };

typedef void (*Function)(void);
typedef Function (*Lookup)(void *, const char *);

static Lookup instance_lookup, device_lookup;
static long submissions, calls;

// Whether calls of this kind fail now, `done` of them having been made.
static int fails(const char *kind, long done) {
    const char *fault = getenv("FAULT");
    size_t length = strlen(kind);
    if (!fault || strncmp(fault, kind, length) || fault[length] != ':') return 0;
    return done > atol(fault + length + 1);
}

static int fails_next(const char *kind) {
    const char *fault = getenv("FAULT");
    if (!fault || strncmp(fault, kind, strlen(kind))) return 0;
    return fails(kind, __sync_add_and_fetch(&calls, 1));
}

static int (*real_submit)(void *, uint32_t, const void *, uint64_t);
static int submit(void *queue, uint32_t count, const void *work, uint64_t fence) {
    if (fails("submit", __sync_add_and_fetch(&submissions, 1))) return DEVICE_LOST;
    return real_submit(queue, count, work, fence);
}

static int (*real_fences)(void *, uint32_t, const uint64_t *, uint32_t, uint64_t);
static int fences(void *device, uint32_t count, const uint64_t *list, uint32_t all, uint64_t patience) {
    if (fails("wait", submissions)) return DEVICE_LOST;
    if (fails("hang", submissions)) return TIMEOUT;
    return real_fences(device, count, list, all, patience);
}

static int (*real_semaphores)(void *, const void *, uint64_t);
static int semaphores(void *device, const void *info, uint64_t patience) {
    if (fails("wait", submissions)) return DEVICE_LOST;
    if (fails("hang", submissions)) return TIMEOUT;
    return real_semaphores(device, info, patience);
}

static int (*real_allocate)(void *, const void *, const void *, void *);
static int allocate(void *device, const void *info, const void *host, void *out) {
    return fails_next("alloc") ? OUT_OF_DEVICE_MEMORY : real_allocate(device, info, host, out);
}

// Allocators ask for large pieces and deal them out: a buffer that cannot be made is how most find the memory full.
static int (*real_buffer)(void *, const void *, const void *, void *);
static int buffer(void *device, const void *info, const void *host, void *out) {
    return fails_next("alloc") ? OUT_OF_DEVICE_MEMORY : real_buffer(device, info, host, out);
}

static int (*real_device)(void *, const void *, const void *, void *);
static int make_device(void *adapter, const void *info, const void *host, void *out) {
    return fails_next("device") ? INITIALIZATION_FAILED : real_device(adapter, info, host, out);
}

static int (*real_pipelines)(void *, uint64_t, uint32_t, const void *, const void *, void *);
static int pipelines(void *device, uint64_t cache, uint32_t count, const void *info, const void *host, void *out) {
    return fails_next("pipeline") ? OUT_OF_HOST_MEMORY : real_pipelines(device, cache, count, info, host, out);
}

// VkPhysicalDeviceProperties: four words, the device's type, its name.
static void pose(char *properties) {
    if (!getenv("FAULT_POSE")) return;
    ((uint32_t *)properties)[4] = DISCRETE_GPU;
    strcpy(properties + 20, "Faulty 1");
}

static void (*real_properties)(void *, void *);
static void properties(void *adapter, void *out) {
    real_properties(adapter, out);
    pose(out);
}

// VkPhysicalDeviceProperties2: a type and a pointer before it.
static void (*real_properties2)(void *, void *);
static void properties2(void *adapter, void *out) {
    real_properties2(adapter, out);
    pose((char *)out + 16);
}

static Function device_function(void *device, const char *name);

static Function replace(const char *name, Function real) {
    struct { const char *name; Function *real; Function ours; } table[] = {
        {"vkQueueSubmit", (Function *)&real_submit, (Function)submit},
        {"vkWaitForFences", (Function *)&real_fences, (Function)fences},
        {"vkWaitSemaphores", (Function *)&real_semaphores, (Function)semaphores},
        {"vkWaitSemaphoresKHR", (Function *)&real_semaphores, (Function)semaphores},
        {"vkAllocateMemory", (Function *)&real_allocate, (Function)allocate},
        {"vkCreateBuffer", (Function *)&real_buffer, (Function)buffer},
        {"vkCreateDevice", (Function *)&real_device, (Function)make_device},
        {"vkCreateComputePipelines", (Function *)&real_pipelines, (Function)pipelines},
        {"vkGetPhysicalDeviceProperties", (Function *)&real_properties, (Function)properties},
        {"vkGetPhysicalDeviceProperties2", (Function *)&real_properties2, (Function)properties2},
        {"vkGetPhysicalDeviceProperties2KHR", (Function *)&real_properties2, (Function)properties2},
        {"vkGetDeviceProcAddr", (Function *)&device_lookup, (Function)device_function},
    };
    for (size_t i = 0; real && i < sizeof table / sizeof *table; i++) {
        if (!strcmp(name, table[i].name)) {
            *table[i].real = real;
            return table[i].ours;
        }
    }
    return real;
}

static Function device_function(void *device, const char *name) { return replace(name, device_lookup(device, name)); }

Function vkGetInstanceProcAddr(void *instance, const char *name) {
    if (!instance_lookup) {
        const char *path = getenv("FAULT_VULKAN");
        void *real = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : 0;
        if (!real) return 0;
        instance_lookup = (Lookup)dlsym(real, "vkGetInstanceProcAddr");
    }
    if (!strcmp(name, "vkGetInstanceProcAddr")) return (Function)vkGetInstanceProcAddr;
    return replace(name, instance_lookup(instance, name));
}
