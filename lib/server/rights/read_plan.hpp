#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <busbar/core/data_value.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/attribute.hpp>

#include "node_rights.hpp"
#include "registered_nodes.hpp"
#include "server/data/data_sources.hpp"

namespace busbar::server::detail {

/// The context of a Read in addition to its request.
struct ReadContext {
    const model::AddressSpace& space;
    DataSources& sources;
    NodeRights rights;
    /// Returns the value of a Variable of namespace 0, or of a session's diagnostics, that is
    /// computed when it is read; fails for any other.
    FunctionRef<Result<DataValue>(const NodeId&)> live_value;
    DateTime server_time;
    /// The source timestamp of values that came with their nodes and were never set: when the
    /// server got them (Part 4, 7.11.3).
    DateTime start_time{};
    /// The reader's locales in order of preference.
    std::span<const std::string> locales{};
    /// The aliases that may be among the NodeIds of the request; may be null.
    const RegisteredNodes* registered{nullptr};
};

/// The source of one attribute's value.
struct ReadPlan {
    /// If null, `answer` has the value, or the reason why there is none.
    SourceEntry* source{nullptr};
    std::uint32_t source_index{model::no_source};
    std::uint64_t handle{0};
    DataValue answer;
};

/// A ReadValueId without its index range; valid as long as its origin.
struct ReadTarget {
    ReadTarget(const ReadValueId& id) : ReadTarget{id.node_id, id.attribute_id, &id.data_encoding}
    {
    }
    /// `encoding` may be null, for the default one.
    ReadTarget(const NodeId& node, std::uint32_t attribute, const QualifiedName* encoding)
        : node_id{node}, attribute_id{attribute}, data_encoding{encoding}
    {
    }

    [[nodiscard]] bool has_default_encoding() const
    {
        return data_encoding == nullptr || data_encoding->name.empty();
    }

    const NodeId& node_id;
    std::uint32_t attribute_id;
    const QualifiedName* data_encoding;
};

/// Looks up node, attribute, rights and data encoding; the caller cuts the index range.
[[nodiscard]] ReadPlan plan_read(const ReadContext& context, const ReadTarget& id);
/// Plans for a caller that has already looked up `node`, no_node if there is none.
[[nodiscard]] ReadPlan plan_read(const ReadContext& context, const ReadTarget& id,
                                 model::NodeIndex node);

} // namespace busbar::server::detail
