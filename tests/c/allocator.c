/* A firmware's heap: one array, from which the library takes all of its memory. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <busbar/busbar.h>

enum { HEAP_SIZE = 16 * 1024 * 1024 };

static union {
    long double alignment;
    char bytes[HEAP_SIZE];
} heap;
static size_t used;
static size_t allocations;
static size_t releases;
static size_t fails_after = (size_t)-1;

static void* allocate(void* context, size_t size, size_t alignment)
{
    size_t from = (used + alignment - 1) / alignment * alignment;
    if (context != &heap || size == 0 || from > HEAP_SIZE || size > HEAP_SIZE - from ||
        allocations >= fails_after) {
        return NULL;
    }
    used = from + size;
    ++allocations;
    return heap.bytes + from;
}

static void release(void* context, void* memory)
{
    (void)context, (void)memory; /* it never gives memory back, as it is a test */
    ++releases;
}

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                        \
            return 1;                                                                              \
        }                                                                                          \
    } while (0)

static busbar_status create(busbar_server** server)
{
    static const busbar_endpoint open = {"None", BUSBAR_MODE_NONE, true, false};
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:test:allocator";
    config.address = "127.0.0.1";
    config.takes_free_port = true;
    config.limits = BUSBAR_LIMITS_SMALL;
    config.endpoints = &open;
    config.endpoint_count = 1;
    return busbar_server_create(&config, server);
}

int main(void)
{
    busbar_allocator mine;
    memset(&mine, 0, sizeof mine);
    mine.size = sizeof mine;
    mine.context = &heap;
    mine.allocate = allocate;
    mine.release = release;
    EXPECT(busbar_set_allocator(NULL) == BUSBAR_BAD_INVALID_ARGUMENT);
    EXPECT(busbar_set_allocator(&mine) == BUSBAR_GOOD);
    EXPECT(busbar_set_allocator(&mine) == BUSBAR_BAD_INVALID_STATE);

    busbar_server* server = NULL;
    EXPECT(create(&server) == BUSBAR_GOOD);
    EXPECT(allocations > 100);
    busbar_memory memory;
    memory.size = sizeof memory;
    EXPECT(busbar_memory_in_use(&memory) == BUSBAR_GOOD);
    EXPECT(memory.allocations - 3 <= allocations);
    EXPECT(memory.bytes > 0 && memory.bytes < used);
    EXPECT(busbar_server_start(server) == BUSBAR_GOOD);
    EXPECT(busbar_server_poll(server, 10) == BUSBAR_GOOD);
    char hash[160];
    EXPECT(busbar_hash_password("x", 1000, hash, sizeof hash) == BUSBAR_GOOD);
    busbar_server_destroy(server);
    EXPECT(busbar_memory_in_use(&memory) == BUSBAR_GOOD);
    printf("%zu allocations, %zu releases, %zu bytes of the heap used, %llu blocks left\n",
           allocations, releases, used, (unsigned long long)memory.blocks);

    /* Without memory it says so. */
    fails_after = allocations;
    EXPECT(create(&server) == BUSBAR_BAD_OUT_OF_MEMORY);
    EXPECT(server == NULL);
    fails_after = allocations + 50;
    EXPECT(create(&server) == BUSBAR_BAD_OUT_OF_MEMORY);
    EXPECT(server == NULL);
    return 0;
}
