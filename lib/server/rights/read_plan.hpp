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

/// What a Read looks at besides its request.
struct ReadContext {
    const model::AddressSpace& space;
    DataSources& sources;
    NodeRights rights;
    /// The value of a Variable of namespace 0, or of a session's diagnostics, that is found when it
    /// is read; fails for any other.
    FunctionRef<Result<DataValue>(const NodeId&)> live_value;
    DateTime server_time;
    /// What the reader would have texts in, the best first.
    std::span<const std::string> locales{};
    /// The aliases that NodeIds of the request may be; may be null.
    const RegisteredNodes* registered{nullptr};
};

/// Where the value of one attribute comes from.
struct ReadPlan {
    /// Null: there is the answer, or why there is none, in `answer`.
    SourceEntry* source{nullptr};
    std::uint32_t source_index{model::no_source};
    std::uint64_t handle{0};
    DataValue answer;
};

/// A ReadValueId without its index range; valid as long as what it was made of.
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

/// Looks up node, attribute, rights and data encoding; the index range is the caller's to cut.
[[nodiscard]] ReadPlan plan_read(const ReadContext& context, const ReadTarget& id);
/// The same for who has looked up `node`, no_node if there is none.
[[nodiscard]] ReadPlan plan_read(const ReadContext& context, const ReadTarget& id,
                                 model::NodeIndex node);

} // namespace busbar::server::detail
