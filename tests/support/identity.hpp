#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/record.hpp>
#include <busbar/crypto/self_signed.hpp>

#include "kept_key.hpp"

namespace busbar::test {

/// 2026-01-01T00:00:00Z, the wall clock of all tests.
inline constexpr DateTime today = DateTime::from_unix_seconds(1'767'225'600);

class FixedWallClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return time; }

    DateTime time{today};
};

/// Keeps what was logged.
class LogBook final : public LogSink {
public:
    void write(LogLevel, std::string_view source, std::string_view message) override
    {
        if (is_broken) {
            throw std::runtime_error{"disk error"};
        }
        text += std::string{source} + ": " + std::string{message} + "\n";
    }

    [[nodiscard]] bool wants(RecordKind) const override { return keeps_records; }
    void record(const Record& record) override
    {
        std::string line = std::string{name(record.kind)} + " " + std::string{name(record.status)} +
                           " " + std::string{record.actor.session_name} + "/" +
                           std::string{record.actor.user} + " " + std::string{record.actor.address};
        for (const RecordField& field : record.fields) {
            line += " " + std::string{field.name};
            if (const auto* const id = field.value.get_if<NodeId>()) {
                node_ids.push_back(to_string(*id));
            }
        }
        line += record.actor.audit_entry_id.empty()
                    ? ""
                    : " by " + std::string{record.actor.audit_entry_id};
        records.push_back(std::move(line));
    }

    std::string text;
    /// Throws away, in both senses.
    bool is_broken{false};
    /// From now on, in `records`.
    bool keeps_records{false};
    /// "SessionCreated Good test/operator 192.0.2.1 RevisedSessionTimeout by audit 7": session,
    /// user, address, names of fields, AuditEntryId.
    std::vector<std::string> records;
    /// The NodeIds in their fields.
    std::vector<std::string> node_ids;
};

/// A kept key (kept_key.hpp) and a self-signed certificate of it, valid for a year around `today`.
[[nodiscard]] inline channel::ApplicationIdentity make_identity(const std::string& name,
                                                                std::uint32_t bits = 2048)
{
    const crypto::PrivateKey key = kept_key(name, bits);
    crypto::CertificateSubject subject;
    subject.common_name = name;
    subject.application_uri = "urn:busbar:test:" + name;
    subject.dns_names = {"localhost"};
    subject.valid_from = DateTime{today.ticks - 30 * 86'400 * DateTime::ticks_per_second};
    subject.valid_days = 365;
    auto certificate = crypto::create_self_signed(key, subject);
    return {{*certificate}, key};
}

[[nodiscard]] inline const channel::ApplicationIdentity& server_identity()
{
    static const auto identity = make_identity("server");
    return identity;
}

[[nodiscard]] inline const channel::ApplicationIdentity& client_identity()
{
    static const auto identity = make_identity("client");
    return identity;
}

} // namespace busbar::test
