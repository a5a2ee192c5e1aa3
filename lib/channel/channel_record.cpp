#include "channel_record.hpp"

#include <array>

#include <busbar/binary/codec.hpp>
#include <busbar/core/record.hpp>
#include <busbar/types/common.hpp>

namespace busbar::channel::detail {

void record_issued(const Conversation& conversation, std::uint32_t channel_id,
                   const OpenSecureChannelRequest& request, bool is_new)
{
    LogSink& log = *conversation.environment().log;
    const RecordKind kind = is_new ? RecordKind::ChannelOpened : RecordKind::ChannelRenewed;
    if (!log.wants(kind)) {
        return;
    }
    const std::array fields{
        RecordField{"RequestType", Variant{static_cast<std::int32_t>(request.request_type)}},
        RecordField{"SecurityPolicyUri", Variant{String{conversation.security.policy->uri}}},
        RecordField{"SecurityMode", Variant{static_cast<std::int32_t>(conversation.security.mode)}},
        RecordField{"RequestedLifetime", Variant{static_cast<double>(request.requested_lifetime)}}};
    Record record{kind, LogLevel::Debug, "channel"};
    record.actor.secure_channel_id = channel_id;
    record.actor.audit_entry_id = request.request_header.audit_entry_id.view();
    record.actor.action_time = request.request_header.timestamp;
    if (const auto& peer = conversation.peer_certificates; !peer.empty()) {
        record.certificate = peer.front().der();
    }
    record.fields = fields;
    log.record(record);
}

void record_closed(const Conversation& conversation, std::uint32_t channel_id,
                   std::span<const std::byte> request)
{
    LogSink& log = *conversation.environment().log;
    if (log.wants(RecordKind::ChannelClosed)) {
        binary::Reader reader{request};
        NodeId type;
        RequestHeader header;
        decode(reader, type);
        decode(reader, header);
        Record record{RecordKind::ChannelClosed, LogLevel::Debug, "channel"};
        record.actor.secure_channel_id = channel_id;
        if (reader.ok()) {
            record.actor.audit_entry_id = header.audit_entry_id.view();
            record.actor.action_time = header.timestamp;
        }
        log.record(record);
    }
}

} // namespace busbar::channel::detail
