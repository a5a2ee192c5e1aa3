#pragma once

#include <cstdint>

#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/server.hpp>

#include "rights.hpp"

/// Nodes of files: Objects of FileType and Methods as namespace 0 declares them (Part 20, 4.2).
namespace busbar::administration::detail {

/// The part of a Variable's handle in addition to the file's number.
enum class FileAspect : std::uint8_t {
    Size,
    Writable,
    UserWritable,
    OpenCount,
    MaxByteStringLength,
    LastModifiedTime,
    Count
};

/// The type of a file, and the source of its Properties' values, whose handles are number *
/// FileAspect::Count + aspect.
struct FileFacts {
    const NodeId& type;
    std::uint32_t source;
    std::uint64_t number;
};
/// Adds the Object of a file, whose NodeId is a string, with its Properties but without Methods, as
/// a part of Thing::Files. After an error some of the nodes may exist.
[[nodiscard]] Result<model::NodeIndex> add_file_object(model::AddressSpace& space,
                                                       const model::NewNode& node,
                                                       const FileFacts& facts,
                                                       const NamedRoles& roles);

/// Returns the MaxByteStringLength of a file: the maximum number of bytes in one Write, and the
/// number that a client can rely on in a Read (Part 20, 4.2.1).
[[nodiscard]] std::uint32_t max_piece(const server::Server& server);

/// A Method as declared in namespace 0, to be added below a node with a string NodeId.
struct DeclaredMethod {
    std::uint32_t declaration;
    model::NodeIndex parent;
    std::uint32_t source;
    std::uint64_t handle;
    Thing thing;
};
/// Adds the Method. Bad_NotSupported if namespace 0 has no such declaration.
[[nodiscard]] Result<model::NodeIndex> add_declared_method(model::AddressSpace& space,
                                                           const DeclaredMethod& method,
                                                           const NamedRoles& roles);

} // namespace busbar::administration::detail
