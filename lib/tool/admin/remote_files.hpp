#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "remote.hpp"

/// Files and folders that a server shares (Part 20, 4.2 and 4.3). All of it throws Failure.
namespace busbar::tool::admin {

/// Bytes of one call at most.
inline constexpr std::size_t transfer_piece = 32'768;

/// Where the folders of a server are.
[[nodiscard]] NodeId file_root(Connection& connection);
/// What people call "recipes/press/4.csv"; null if it is not there.
[[nodiscard]] NodeId look_for_file(Connection& connection, std::string_view path);
/// The value of a Property; null if there is none.
[[nodiscard]] Variant file_property(Connection& connection, const NodeId& node, const char* name);
/// How many bytes of the file a Write may have (Part 20, 4.2.1): not above `transfer_piece`.
[[nodiscard]] std::size_t piece_to_write(Connection& connection, const NodeId& file);
/// The outputs of a Method of the file or folder, which people call `path`.
std::vector<Variant> call_on_file(Connection& connection, const NodeId& node,
                                  const std::string& path, const char* method,
                                  const std::vector<Variant>& inputs);

/// What is fetched of a file.
struct Download {
    std::uint64_t offset{0};
    /// A server that sends more is not believed.
    std::size_t max_size{256U << 20U};
    /// Somebody adds to the file meanwhile: what was there when it was read last is good enough.
    bool is_growing{false};
    /// Is told how many bytes there are; may be empty.
    std::function<void(std::size_t)> progress{};
};
[[nodiscard]] std::string download(Connection& connection, const NodeId& node,
                                   const std::string& path, const Download& what);
/// On a terminal, for what takes more than one call.
void show_progress(Context& context, std::size_t done, std::size_t all);

} // namespace busbar::tool::admin
