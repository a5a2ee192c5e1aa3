#include "limit_keys.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::product {

namespace {

/// Memory of one connection in net::ServerLoop: socket, timer and link.
constexpr std::size_t bytes_of_link = 4'096;
constexpr std::string_view expected_size = "a size from \"1 MB\" to \"1024 GB\", such as \"64 MB\"";
constexpr std::uint64_t least_memory = 1'000'000;
constexpr std::uint64_t most_machine_memory = 1'024'000'000'000;

struct Unit {
    std::string_view name;
    std::uint64_t bytes;
};
constexpr std::array units{Unit{"kB", 1'000},         Unit{"KiB", 1U << 10U},
                           Unit{"MB", 1'000'000},     Unit{"MiB", 1U << 20U},
                           Unit{"GB", 1'000'000'000}, Unit{"GiB", 1U << 30U}};

/// Parses an integer with a unit; nothing for other texts.
std::optional<std::uint64_t> parse_size(std::string_view text)
{
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{}) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    for (const Unit& unit : units) {
        if (text == unit.name && number <= most_machine_memory / unit.bytes) {
            return number * unit.bytes;
        }
    }
    return std::nullopt;
}

/// The options of an image's source: its writes wait for the edge of a scan.
server::DataSourceOptions options_of(const server::ImageOptions& image)
{
    server::DataSourceOptions options;
    options.max_batches = std::size_t{image.max_waiting_writes} + 2;
    return options;
}

/// Limits what waits for the edge of a scan to a part of the memory, or to the default if that is
/// less.
void take_waiting(std::uint64_t memory, server::ImageOptions& image)
{
    constexpr std::uint64_t for_a_write = 32'000'000;
    constexpr std::uint64_t fewest = 4;
    constexpr std::uint64_t part = 16;
    image.max_waiting_writes = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(memory / for_a_write, fewest, image.max_waiting_writes));
    image.max_waiting_bytes =
        static_cast<std::size_t>(std::min<std::uint64_t>(memory / part, image.max_waiting_bytes));
}

/// Returns the cost of the hash, present or future, that takes the most memory.
crypto::PasswordCost costliest(const UserConfig& users)
{
    crypto::PasswordCost most = users.password_rules.cost;
    for (const Account& account : users.accounts) {
        const auto cost = crypto::cost_of(account.password_hash);
        if (cost && crypto::memory_of(*cost) > crypto::memory_of(most)) {
            most = *cost;
        }
    }
    return most;
}

} // namespace

std::optional<std::uint64_t> read_memory(const TomlTable& limits)
{
    if (!limits.has("memory")) {
        return std::nullopt;
    }
    const auto size = parse_size(limits.text("memory"));
    if (!size || *size < least_memory || *size > most_machine_memory) {
        limits.fail("memory", std::string{expected_size});
    }
    return size;
}

void take_memory(const TomlTable& root, std::uint64_t memory, ControllerConfig& config)
{
    const TomlTable limits = root.table("limits");
    take_waiting(memory, config.image);
    const server::DataSourceOptions source = options_of(config.image);
    const auto image = server::ProcessImage::create({}, config.image);
    const server::ProcessImage* const images[] = {image.get()};
    server::MemoryAssumptions other{.has_channel_worker = true,
                                    .slow_sources = {&source, 1},
                                    .images = images,
                                    .connection_bytes = bytes_of_link};
    const std::string scheme = root.table("users").text("password_hash", "");
    if (scheme == "pbkdf2") {
        other.password_cost.scheme = crypto::PasswordScheme::Pbkdf2;
    }
    auto found = server::limits_for(memory, other);
    if (!found) {
        const std::uint64_t least =
            server::worst_case_memory(server::small_controller_limits(), other).total();
        limits.refuse("memory", "found " + size_text(memory) + ", expected at least " +
                                    size_text(least) +
                                    (scheme == "pbkdf2"
                                         ? std::string{}
                                         : ", of which the check of a password takes " +
                                               size_text(crypto::memory_of(other.password_cost)) +
                                               ": password_hash = \"pbkdf2\" in [users] takes "
                                               "next to nothing"));
    }
    config.server.limits = *std::move(found);
}

void check_memory(const TomlTable& limits, const ControllerConfig& config)
{
    const auto memory = read_memory(limits);
    const std::uint64_t all = worst_case_of(config).total();
    if (memory && all > *memory) {
        limits.refuse("memory", "found " + size_text(*memory) +
                                    " and other limits with which "
                                    "clients can take " +
                                    size_text(all) +
                                    ", expected limits for this memory: --print-limits shows what "
                                    "each takes");
    }
}

server::WorstCaseMemory worst_case_of(const ControllerConfig& config)
{
    return worst_case_of(config, *server::ProcessImage::create({}, config.image));
}

server::WorstCaseMemory worst_case_of(const ControllerConfig& config,
                                      const server::ProcessImage& image)
{
    std::vector<server::DataSourceOptions> sources(config.backends.size());
    sources.push_back(options_of(config.image));
    const server::ProcessImage* const images[] = {&image};
    return server::worst_case_memory(config.server.limits,
                                     {.password_checks = config.users.accounts.empty() ? 0U : 1U,
                                      .password_cost = costliest(config.users),
                                      .has_channel_worker = true,
                                      .slow_sources = sources,
                                      .images = images,
                                      .connection_bytes = bytes_of_link});
}

std::string size_text(std::uint64_t bytes)
{
    if (bytes == std::numeric_limits<std::uint64_t>::max()) {
        return "no end";
    }
    constexpr std::array names{"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
    if (bytes < 1'024) {
        return std::to_string(bytes) + " B";
    }
    double size = static_cast<double>(bytes) / 1'024;
    std::size_t unit = 0;
    for (; size >= 1'023.95 && unit + 1 < names.size(); ++unit) {
        size /= 1'024;
    }
    char text[32];
    static_cast<void>(std::snprintf(text, sizeof text, "%.1f %s", size, names[unit]));
    return text;
}

} // namespace busbar::product
