#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <unordered_set>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/attribute.hpp>

#include "server/session/session_record.hpp"

namespace busbar::server::detail {

/// Returns the Variables whose values have another meaning now: those with Properties, for example
/// EURange, that a client wrote successfully (Part 8, 5.2; Part 3, 8.57). `nodes` and `result` are
/// as for WriteObserver.
[[nodiscard]] std::unordered_set<NodeId>
find_semantic_changes(const model::AddressSpace& space, const WriteRequest& request,
                      std::span<const model::NodeHandle> nodes,
                      FunctionRef<StatusCode(std::size_t)> result);

/// Records each node of a Write, if the log wants it (Part 5, 6.4.27), without the previous value,
/// which a data source is not asked for.
inline void record_write(LogSink& log, const Session* session, const RequestMark& mark,
                         const WriteRequest& request, FunctionRef<StatusCode(std::size_t)> result)
{
    if (session == nullptr || !log.wants(RecordKind::AttributeWritten)) {
        return;
    }
    for (std::size_t i = 0; i < request.nodes_to_write.size(); ++i) {
        const WriteValue& written = request.nodes_to_write[i];
        const std::array fields{RecordField{"NodeId", Variant{written.node_id}},
                                RecordField{"AttributeId", Variant{written.attribute_id}},
                                RecordField{"IndexRange", Variant{written.index_range}},
                                RecordField{"NewValue", written.value.value}};
        Record record{RecordKind::AttributeWritten, LogLevel::Debug, "attribute"};
        record.status = result(i);
        record.actor = actor_of(*session, mark);
        record.fields = fields;
        log.record(record);
    }
}

} // namespace busbar::server::detail
