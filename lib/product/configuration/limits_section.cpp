#include "sections.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <vector>

#include "limit_keys.hpp"
#include "presets.hpp"

namespace busbar::product {

namespace {

constexpr std::uint32_t bytes_of_a_chunk = 32'768;
/// Size of a response in addition to the value.
constexpr std::uint64_t headers = 1'024;

constexpr std::string_view operations = "operations.";
constexpr std::array<std::string_view, 5> limit_tables{
    "limits", "limits.events", "limits.subscriptions", "limits.certificates", "users.passwords"};
constexpr std::int64_t longest_interval = 86'400'000;
constexpr double most_overload = 1'000;

/// Finds the table "limits.subscriptions" in the root.
TomlTable table_of(const TomlTable& root, std::string_view path)
{
    const std::size_t point = path.find('.');
    const TomlTable table = root.table(path.substr(0, point));
    return point == std::string_view::npos ? table : table_of(table, path.substr(point + 1));
}

/// Keys of [limits] and the tables below it that are not a LimitKey.
std::vector<std::string_view> other_keys(std::string_view table)
{
    if (table == "limits") {
        return {"preset", "memory", "events", "subscriptions", "certificates"};
    }
    if (table == "limits.subscriptions") {
        return {"samples_each_scan", "sampling_intervals_ms", "overload_percent"};
    }
    if (table == "limits.certificates") {
        return {"when_rejected_is_full"};
    }
    if (table == "users.passwords") {
        return {"needs_letters_and_digit", "name_characters", "password_characters",
                "reserved_names"};
    }
    return {};
}

void allow_keys(const TomlTable& table, std::string_view path)
{
    std::vector<std::string_view> allowed = other_keys(path);
    for (const LimitKey& key : limit_keys()) {
        if (key.table == path) {
            allowed.push_back(key.name);
        }
    }
    table.allow(allowed);
}

/// Checks the number of operations: they form an array, and one operation too many must still fit
/// the array limit, so that it is refused as such.
void check_operations(const TomlTable& table, const LimitKey& key, ControllerConfig& config)
{
    const std::int64_t most = std::int64_t{config.server.limits.decode.max_array_length} - 1;
    if (!table.has(key.name)) {
        key.set(config, std::min(key.get(config), most));
    } else if (key.get(config) > most) {
        table.refuse(key.name, "found " + std::to_string(key.get(config)) + ", expected at most " +
                                   std::to_string(most) +
                                   ", one below the array_length: raise that one too");
    }
}

/// Makes limits of buffers hold several messages, unless the configuration sets them.
void make_room(const TomlTable& table, server::ServerLimits& limits)
{
    const std::uint32_t message = limits.transport.max_message_size;
    const auto raise = [&](std::string_view key, auto& limit, std::size_t least) {
        using Limit = std::remove_reference_t<decltype(limit)>;
        if (!table.has(key)) {
            limit = std::max(limit, static_cast<Limit>(least));
        }
    };
    raise("chunk_count", limits.transport.max_chunk_count, message / bytes_of_a_chunk);
    raise("assembly", limits.max_assembly, std::size_t{4} * message);
    raise("send_queue", limits.max_send_queue, std::size_t{2} * message);
    raise("session_memory", limits.max_session_memory, std::size_t{4} * message);
}

void read_sampling(const TomlTable& table, server::SamplingPolicy& sampling)
{
    sampling.samples_each_scan = table.flag("samples_each_scan", sampling.samples_each_scan);
    if (table.has("sampling_intervals_ms")) {
        sampling.intervals.clear();
        for (const std::int64_t interval :
             table.integers("sampling_intervals_ms", 1, longest_interval)) {
            sampling.intervals.emplace_back(interval);
        }
        if (!std::is_sorted(sampling.intervals.begin(), sampling.intervals.end())) {
            table.fail("sampling_intervals_ms", "numbers in ascending order");
        }
    }
    if (table.has("overload_percent")) {
        const double percent = table.number("overload_percent", 0);
        if (!(percent >= 0 && percent <= most_overload)) {
            table.fail("overload_percent", "a number from 0 (never) to 1000");
        }
        sampling.overload_percent = percent > 0 ? std::optional{percent} : std::nullopt;
    }
}

void read_when_full(const TomlTable& table, crypto::StoreLimits& limits)
{
    if (!table.has("when_rejected_is_full")) {
        return;
    }
    const std::string text = table.text("when_rejected_is_full");
    if (text != "oldest out" && text != "discard") {
        table.fail("when_rejected_is_full", "\"oldest out\" or \"discard\"");
    }
    limits.when_rejected_is_full =
        text == "discard" ? crypto::RejectedFull::Discard : crypto::RejectedFull::OldestOut;
}

void read_password_rules(const TomlTable& table, server::PasswordRules& rules)
{
    rules.needs_letters_and_digit =
        table.flag("needs_letters_and_digit", rules.needs_letters_and_digit);
    rules.name_characters = table.text("name_characters", rules.name_characters);
    rules.password_characters = table.text("password_characters", rules.password_characters);
    if (table.has("reserved_names")) {
        rules.reserved_names = table.texts("reserved_names");
    }
    if (rules.min_name_length > rules.max_name_length ||
        rules.min_password_length > rules.max_password_length) {
        table.fail("min_password_length", "minimum lengths that are not above the maximum ones");
    }
}

/// Size on the wire (Part 6, 5.2.2); the maximum for texts.
std::uint64_t encoded_size(const controller::PlcVariable& variable)
{
    switch (variable.type) {
    case BuiltInType::Boolean:
    case BuiltInType::SByte:
    case BuiltInType::Byte:
        return 1;
    case BuiltInType::Int16:
    case BuiltInType::UInt16:
        return 2;
    case BuiltInType::Int32:
    case BuiltInType::UInt32:
    case BuiltInType::Float:
    case BuiltInType::StatusCode:
        return 4;
    case BuiltInType::Guid:
        return 16;
    case BuiltInType::String:
    case BuiltInType::ByteString:
    case BuiltInType::XmlElement:
        return std::uint64_t{4} + variable.capacity;
    default:
        return 8;
    }
}

void check_text(const TomlTable& entry, const controller::PlcVariable& variable,
                const binary::DecodeLimits& limits)
{
    const bool is_bytes = variable.type == BuiltInType::ByteString;
    const bool is_text =
        variable.type == BuiltInType::String || variable.type == BuiltInType::XmlElement;
    const std::uint32_t most = is_bytes ? limits.max_byte_string_length : limits.max_string_length;
    if ((is_bytes || is_text) && variable.capacity > most) {
        entry.refuse("capacity",
                     "found " + std::to_string(variable.capacity) + " bytes, expected at most " +
                         std::to_string(most) + ": raise " +
                         (is_bytes ? "byte_string_length" : "string_length") + " in [limits]");
    }
}

} // namespace

void read_preset(const TomlTable& root, ControllerConfig& config)
{
    const TomlTable table = root.table("limits");
    const std::string name = table.text("preset", "");
    const auto memory = read_memory(table);
    if (name.empty()) {
        return memory ? take_memory(root, *memory, config) : void();
    }
    if (memory) {
        table.refuse("memory", "found with the preset \"" + name +
                                   "\", expected one of the two: a preset has the limits of a "
                                   "product");
    }
    const Preset* const preset = find_preset(name);
    if (preset == nullptr) {
        table.fail("preset", std::string{preset_names});
    }
    preset->take(config);
}

void read_limits(const TomlTable& root, ControllerConfig& config)
{
    for (const std::string_view path : limit_tables) {
        const TomlTable table = table_of(root, path);
        allow_keys(table, path);
        read_numbers(table, path, config);
    }
    const TomlTable limits = root.table("limits");
    for (const LimitKey& key : limit_keys()) {
        if (key.cost.starts_with(operations)) {
            check_operations(limits, key, config);
        }
    }
    if (!limits.has("memory") || limits.has("message_size")) {
        make_room(limits, config.server.limits);
    }
    read_sampling(limits.table("subscriptions"), config.server.limits.subscriptions.sampling);
    read_when_full(limits.table("certificates"), config.certificates.limits);
    read_password_rules(root.table("users").table("passwords"), config.users.password_rules);
}

void check_size(const TomlTable& entry, const controller::PlcVariable& variable,
                const server::ServerLimits& limits)
{
    check_text(entry, variable, limits.decode);
    std::uint64_t elements = 1;
    for (const std::uint32_t size : variable.dimensions) {
        // Stop at one more than allowed.
        elements = std::min<std::uint64_t>(elements * size, most_elements + 1);
    }
    if (elements > limits.decode.max_array_length) {
        entry.refuse("dimensions",
                     "found " + std::to_string(elements) + " elements, expected at most " +
                         std::to_string(limits.decode.max_array_length) +
                         ": raise array_length in [limits], or no client could write all of it");
    }
    const std::uint64_t bytes = elements * encoded_size(variable) + headers;
    if (bytes > limits.transport.max_message_size) {
        entry.refuse(variable.dimensions.empty() ? "capacity" : "dimensions",
                     "found a value of " + std::to_string(bytes) +
                         " bytes with its message, expected at most " +
                         std::to_string(limits.transport.max_message_size) +
                         ": raise message_size in [limits]");
    }
}

} // namespace busbar::product
