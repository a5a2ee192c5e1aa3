#pragma once

#include <array>
#include <span>

#include <busbar/types/node_management.hpp>

#include "server/session/session_record.hpp"

/// Records each node or reference that a client adds or deletes, if the log wants it (Part 5,
/// 6.4.21 to 6.4.25).
namespace busbar::server::detail {

inline void record_change(LogSink& log, const Session& session, const RequestMark& mark,
                          RecordKind kind, StatusCode status, std::span<const RecordField> fields)
{
    Record record{kind, LogLevel::Debug, "node management"};
    record.status = status;
    record.actor = actor_of(session, mark);
    record.fields = fields;
    log.record(record);
}

inline void record_change(LogSink& log, const Session& session, const RequestMark& mark,
                          const AddNodesItem& item, const AddNodesResult& result)
{
    if (log.wants(RecordKind::NodesAdded)) {
        const std::array fields{RecordField{"NodeId", Variant{result.added_node_id}},
                                RecordField{"ParentNodeId", Variant{item.parent_node_id}}};
        record_change(log, session, mark, RecordKind::NodesAdded, result.status_code, fields);
    }
}

inline void record_change(LogSink& log, const Session& session, const RequestMark& mark,
                          const DeleteNodesItem& item, StatusCode result)
{
    if (log.wants(RecordKind::NodesDeleted)) {
        const std::array fields{RecordField{"NodeId", Variant{item.node_id}}};
        record_change(log, session, mark, RecordKind::NodesDeleted, result, fields);
    }
}

inline void record_change(LogSink& log, const Session& session, const RequestMark& mark,
                          const AddReferencesItem& item, StatusCode result)
{
    if (log.wants(RecordKind::ReferencesAdded)) {
        const std::array fields{RecordField{"SourceNodeId", Variant{item.source_node_id}},
                                RecordField{"ReferenceTypeId", Variant{item.reference_type_id}},
                                RecordField{"TargetNodeId", Variant{item.target_node_id}}};
        record_change(log, session, mark, RecordKind::ReferencesAdded, result, fields);
    }
}

inline void record_change(LogSink& log, const Session& session, const RequestMark& mark,
                          const DeleteReferencesItem& item, StatusCode result)
{
    if (log.wants(RecordKind::ReferencesDeleted)) {
        const std::array fields{RecordField{"SourceNodeId", Variant{item.source_node_id}},
                                RecordField{"ReferenceTypeId", Variant{item.reference_type_id}},
                                RecordField{"TargetNodeId", Variant{item.target_node_id}}};
        record_change(log, session, mark, RecordKind::ReferencesDeleted, result, fields);
    }
}

} // namespace busbar::server::detail
