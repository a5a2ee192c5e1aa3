#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "remote.hpp"

/// Access to files and folders that a server shares (Part 20, 4.2 and 4.3). All functions throw
/// Failure.
namespace busbar::tool::admin {

/// Maximum number of bytes in one call.
inline constexpr std::size_t transfer_piece = 32'768;

/// The root of the server's folders.
[[nodiscard]] NodeId file_root(Connection& connection);
/// Finds a file by its path, "recipes/press/4.csv"; null if it does not exist.
[[nodiscard]] NodeId look_for_file(Connection& connection, std::string_view path);
/// Reads a Property; null if there is none.
[[nodiscard]] Variant file_property(Connection& connection, const NodeId& node, const char* name);
/// Number of bytes that one Write to the file may have (Part 20, 4.2.1), at most `transfer_piece`.
[[nodiscard]] std::size_t piece_to_write(Connection& connection, const NodeId& file);
/// Calls a Method of the file or folder with this `path` and returns the outputs.
std::vector<Variant> call_on_file(Connection& connection, const NodeId& node,
                                  const std::string& path, const char* method,
                                  const std::vector<Variant>& inputs);

/// The part of a file to fetch.
struct Download {
    std::uint64_t offset{0};
    /// Protects against a server that sends without end.
    std::size_t max_size{256U << 20U};
    /// The file may grow in the meantime; the state of the last Read is enough.
    bool is_growing{false};
    /// Called with the number of bytes so far; may be empty.
    std::function<void(std::size_t)> progress{};
};
[[nodiscard]] std::string download(Connection& connection, const NodeId& node,
                                   const std::string& path, const Download& what);
/// Shows progress on a terminal, if more than one call is needed.
void show_progress(Context& context, std::size_t done, std::size_t all);

} // namespace busbar::tool::admin
