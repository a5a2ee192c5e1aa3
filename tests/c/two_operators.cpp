// A program that replaces two of the forms of operator new and delete, as most do that replace any:
// all memory of plain alignment is its own, and the others agree.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <busbar/busbar.h>

namespace {

/// Stands before each of the program's blocks.
struct alignas(std::max_align_t) Mark {
    std::uint64_t mine;
};
constexpr std::uint64_t in_use = 0x6d696e65'6d696e65;
constexpr std::uint64_t released = 0x66726565'66726565;
std::size_t blocks = 0;
std::size_t foreign = 0;

struct alignas(256) Wide {
    char bytes[256];
};

bool expect(bool is_true, const char* what)
{
    if (!is_true) {
        std::fprintf(stderr, "failed: %s\n", what);
    }
    return is_true;
}

busbar_status create(busbar_server** server)
{
    const busbar_endpoint open{"None", BUSBAR_MODE_NONE, true, false};
    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:test:two-operators";
    config.address = "127.0.0.1";
    config.takes_free_port = true;
    config.endpoints = &open;
    config.endpoint_count = 1;
    return busbar_server_create(&config, server);
}

} // namespace

void* operator new(std::size_t size)
{
    void* const memory = std::malloc(sizeof(Mark) + size);
    if (memory == nullptr) {
        throw std::bad_alloc{};
    }
    ++blocks;
    return ::new (memory) Mark{in_use} + 1;
}

void operator delete(void* block) noexcept
{
    if (block == nullptr) {
        return;
    }
    Mark* const mark = static_cast<Mark*>(block) - 1;
    if (mark->mine != in_use) {
        ++foreign; // another form took it, or it was given back before
        return;
    }
    mark->mine = released;
    --blocks;
    std::free(mark);
}

int main()
{
    bool is_good = true;
    const std::size_t before = blocks;
    {
        const auto one = std::make_unique<int>(1);
        const auto many = std::make_unique<int[]>(100);
        const std::vector<double> sized(100);
        const std::string text(100, 'x');
        const std::unique_ptr<int> quiet{new (std::nothrow) int{1}};
        const std::unique_ptr<int[]> quiet_many{new (std::nothrow) int[100]};
        is_good &= expect(blocks == before + 6, "each plain form takes from the program's");
        const auto wide = std::make_unique<Wide>();
        const auto wide_many = std::make_unique<Wide[]>(2);
        is_good &= expect(reinterpret_cast<std::uintptr_t>(wide.get()) % 256 == 0, "alignment");
    }
    is_good &= expect(blocks == before, "each plain form gives back to the program's");

    busbar_server* server = nullptr;
    is_good &= expect(create(&server) == BUSBAR_GOOD, "a server is created");
    is_good &= expect(busbar_server_start(server) == BUSBAR_GOOD, "it starts");
    is_good &= expect(busbar_server_poll(server, 10) == BUSBAR_GOOD, "it serves");
    busbar_server_destroy(server);

    busbar_allocator allocator{};
    allocator.size = sizeof allocator;
    allocator.allocate = [](void*, std::size_t, std::size_t) -> void* { return nullptr; };
    allocator.release = [](void*, void*) {};
    is_good &= expect(busbar_set_allocator(&allocator) == BUSBAR_BAD_NOT_SUPPORTED,
                      "set_allocator says that the operators are the program's");
    busbar_memory memory{};
    memory.size = sizeof memory;
    is_good &= expect(busbar_memory_in_use(&memory) == BUSBAR_BAD_NOT_SUPPORTED,
                      "and so does memory_in_use");
    is_good &= expect(foreign == 0, "nothing foreign was given back");
    return is_good ? 0 : 1;
}
