#pragma once

#include <cstdint>

#include <busbar/core/node_id.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/server.hpp>

#include "rights.hpp"

/// Nodes of files: Objects of FileType and Methods as namespace 0 declares them (Part 20, 4.2).
namespace busbar::administration::detail {

/// What a Variable's handle says besides the file's number.
enum class FileAspect : std::uint8_t {
    Size,
    Writable,
    UserWritable,
    OpenCount,
    MaxByteStringLength,
    LastModifiedTime,
    Count
};

/// Its type, and the source that has the values of its Properties under the handles number *
/// FileAspect::Count + aspect.
struct FileFacts {
    const NodeId& type;
    std::uint32_t source;
    std::uint64_t number;
};
/// Adds the Object of a file, whose NodeId is a text, with its Properties and without Methods, as a
/// part of Thing::Files. The node may be there in part after an error.
[[nodiscard]] Result<model::NodeIndex> add_file_object(model::AddressSpace& space,
                                                       const model::NewNode& node,
                                                       const FileFacts& facts,
                                                       const NamedRoles& roles);

/// MaxByteStringLength of a file: how many bytes a Write of it may have, and a client may count on
/// in a Read (Part 20, 4.2.1).
[[nodiscard]] std::uint32_t max_piece(const server::Server& server);

/// A Method as the one in namespace 0 says, below a node whose NodeId is a text.
struct DeclaredMethod {
    std::uint32_t declaration;
    model::NodeIndex parent;
    std::uint32_t source;
    std::uint64_t handle;
    Thing thing;
};
/// Adds it. Bad_NotSupported if namespace 0 has no such declaration.
[[nodiscard]] Result<model::NodeIndex> add_declared_method(model::AddressSpace& space,
                                                           const DeclaredMethod& method,
                                                           const NamedRoles& roles);

} // namespace busbar::administration::detail
