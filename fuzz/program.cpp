#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

#include <busbar/core/version.hpp>

#include "target.hpp"

/// All fuzz targets are one program, which is linked once. A link to it, fuzz_<name>, runs the
/// target of that name.
namespace {

using busbar::fuzz::Target;

const Target* chosen = nullptr;

[[nodiscard]] bool choose(std::string_view program)
{
    constexpr std::string_view prefix = "fuzz_";
    const std::string_view name = program.substr(program.rfind('/') + 1);
    for (const Target& target : busbar::fuzz::targets()) {
        if (name.starts_with(prefix) && name.substr(prefix.size()) == target.name) {
            chosen = &target;
            return true;
        }
    }
    std::fprintf(stderr, "%s: run this program by a link to it, fuzz_<name>, with a name of:\n",
                 program.data());
    for (const Target& target : busbar::fuzz::targets()) {
        std::fprintf(stderr, "  %s\n", target.name);
    }
    return false;
}

/// Answers --version, as all programs do.
bool has_told_version(int argc, const char* const* argv)
{
    if (argc != 2 || std::string_view{argv[1]} != "--version") {
        return false;
    }
    std::printf("busbar-fuzz %s\n", busbar::version());
    return true;
}

} // namespace

#ifdef BUSBAR_LIBFUZZER

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv)
{
    if (has_told_version(*argc, *argv)) {
        std::exit(0);
    }
    if (!choose((*argv)[0])) {
        std::exit(2);
    }
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    return chosen->test_one_input(data, size);
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed)
{
    return chosen->mutate != nullptr ? chosen->mutate(data, size, max_size, seed)
                                     : LLVMFuzzerMutate(data, size, max_size);
}

namespace busbar::fuzz {

bool is_searching()
{
    return true;
}

std::size_t mutate_bytes(std::uint8_t* data, std::size_t size, std::size_t max_size)
{
    return LLVMFuzzerMutate(data, size, max_size);
}

} // namespace busbar::fuzz

#else

namespace busbar::fuzz {

bool is_searching()
{
    return false;
}

std::size_t mutate_bytes(std::uint8_t*, std::size_t size, std::size_t)
{
    return size;
}

} // namespace busbar::fuzz

namespace {

std::vector<std::uint8_t> read(const std::filesystem::path& path)
{
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

} // namespace

/// Gives every file of the folder to the target; the target ends the program if it fails.
int main(int argc, char** argv)
{
    if (has_told_version(argc, argv)) {
        return 0;
    }
    if (!choose(argv[0])) {
        return 2;
    }
    if (argc != 2 || !std::filesystem::is_directory(argv[1])) {
        std::fprintf(stderr, "usage: %s <corpus folder>\n", argv[0]);
        return 2;
    }
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator{argv[1]}) {
        const auto data = read(entry.path());
        chosen->test_one_input(data.data(), data.size());
        ++count;
    }
    std::printf("%zu inputs replayed\n", count);
    return count != 0 ? 0 : 1;
}

#endif
