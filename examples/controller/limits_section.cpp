#include "limits_section.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>

#include "presets.hpp"

namespace busbar::example {

namespace {

constexpr std::int64_t most_connections = 100'000;
constexpr std::int64_t most_references = 10'000'000;
constexpr std::int64_t most_bytes = 67'108'864;
constexpr std::int64_t least_message = 8'192; // Part 6, 7.1.2.3: the least buffer
constexpr std::int64_t least_elements = 2;
constexpr std::uint32_t bytes_of_a_chunk = 32'768;
/// What a response has besides the value.
constexpr std::uint64_t headers = 1'024;

/// A key of [limits] and the limit that it sets.
struct Key {
    std::string_view name;
    std::string_view limit;
};
constexpr std::array keys{
    Key{"connections", "max_connections"},
    Key{"connections_per_address", "max_connections_per_address"},
    Key{"sessions", "max_sessions"},
    Key{"nodes_per_read", "operations.max_nodes_per_read"},
    Key{"nodes_per_write", "operations.max_nodes_per_write"},
    Key{"nodes_per_browse", "operations.max_nodes_per_browse"},
    Key{"references_per_node", "max_references_per_node"},
    Key{"message_size", "transport.max_message_size"},
    Key{"array_length", "decode.max_array_length"},
    Key{"string_length", "decode.max_string_length"},
    Key{"byte_string_length", "decode.max_byte_string_length"},
};

template <typename T>
void read(const TomlTable& table, std::string_view key, T& limit, std::int64_t least,
          std::int64_t most)
{
    limit = static_cast<T>(table.integer(key, static_cast<std::int64_t>(limit), least, most));
}

/// The operations of a request are an array, too, and one too many must not be too long for one.
void read_operations(const TomlTable& table, std::string_view key, std::uint32_t& limit,
                     std::uint32_t array_length)
{
    if (!table.has(key)) {
        limit = std::min(limit, array_length - 1);
        return;
    }
    read(table, key, limit, 1, most_elements);
    if (limit >= array_length) {
        table.refuse(key, "found " + std::to_string(limit) + ", expected at most " +
                              std::to_string(array_length - 1) +
                              ", one below the array_length: raise that one too");
    }
}

/// As on the wire (Part 6, 5.2.2); the most that a text can have.
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

std::string_view key_of(std::string_view limit)
{
    const auto* const found =
        std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.limit == limit; });
    return found == keys.end() ? std::string_view{} : found->name;
}

void read_preset(const TomlTable& table, ControllerConfig& config)
{
    if (!table.has("preset")) {
        return;
    }
    const auto preset = find_preset(table.text("preset", ""));
    if (!preset) {
        table.fail("preset", std::string{preset_names});
    }
    config.server.limits = preset->limits;
    config.certificates.limits = preset->store;
    config.users.password_rules = preset->passwords;
}

void read_limits(const TomlTable& table, server::ServerLimits& limits)
{
    table.allow({"preset", "connections", "connections_per_address", "sessions", "nodes_per_read",
                 "nodes_per_write", "nodes_per_browse", "references_per_node", "message_size",
                 "array_length", "string_length", "byte_string_length"});
    read(table, "connections", limits.max_connections, 1, most_connections);
    read(table, "connections_per_address", limits.max_connections_per_address, 1, most_connections);
    read(table, "sessions", limits.max_sessions, 1, most_connections);
    read(table, "references_per_node", limits.max_references_per_node, 1, most_references);
    read(table, "array_length", limits.decode.max_array_length, least_elements, most_elements);
    read(table, "string_length", limits.decode.max_string_length, 256, most_bytes);
    read(table, "byte_string_length", limits.decode.max_byte_string_length, 256, most_bytes);
    const std::uint32_t array_length = limits.decode.max_array_length;
    server::OperationLimits& operations = limits.operations;
    read_operations(table, "nodes_per_read", operations.max_nodes_per_read, array_length);
    read_operations(table, "nodes_per_write", operations.max_nodes_per_write, array_length);
    read_operations(table, "nodes_per_browse", operations.max_nodes_per_browse, array_length);
    for (std::uint32_t* without_key :
         {&operations.max_nodes_per_register_nodes,
          &operations.max_nodes_per_translate_browse_paths, &operations.max_nodes_per_method_call,
          &operations.max_nodes_per_node_management, &operations.max_monitored_items_per_call}) {
        *without_key = std::min(*without_key, array_length - 1);
    }
    std::uint32_t& message = limits.transport.max_message_size;
    read(table, "message_size", message, least_message, most_bytes);
    // What holds messages must have room for some of them.
    limits.transport.max_chunk_count =
        std::max(limits.transport.max_chunk_count, message / bytes_of_a_chunk);
    limits.max_assembly = std::max(limits.max_assembly, std::size_t{4} * message);
    limits.max_send_queue = std::max(limits.max_send_queue, std::size_t{2} * message);
    limits.max_session_memory = std::max(limits.max_session_memory, std::size_t{4} * message);
}

void check_size(const TomlTable& entry, const controller::PlcVariable& variable,
                const server::ServerLimits& limits)
{
    check_text(entry, variable, limits.decode);
    std::uint64_t elements = 1;
    for (const std::uint32_t size : variable.dimensions) {
        // One past it is enough to know.
        elements = std::min<std::uint64_t>(elements * size, most_elements + 1);
    }
    if (elements > limits.decode.max_array_length) {
        entry.refuse("dimensions", "found " + std::to_string(elements) +
                                       " elements, expected at most " +
                                       std::to_string(limits.decode.max_array_length) +
                                       ": raise array_length in [limits], or nobody could write "
                                       "all of it");
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

} // namespace busbar::example
