#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/record.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/server/method_table.hpp>

namespace busbar::administration::detail {

/// Tells whether the answer of a Method has the status of its record. A refusal that is answered
/// with Good and told in an output has an audit event of its own: its record does not name the
/// Method, whose event shows a success.
enum class MethodAnswer : std::uint8_t { HasStatus, IsGood };

/// Records what a Method of the administration did or, with a `refusal`, why it did nothing. `more`
/// are the fields of its event type. If there is no memory for the record it is lost, because the
/// Method's effect cannot be undone.
inline void tell_method(LogSink& log, RecordKind kind, const server::MethodCall& call,
                        StatusCode status, const Refusal* refusal,
                        std::span<const RecordField> more = {},
                        std::span<const std::byte> certificate = {},
                        MethodAnswer answer = MethodAnswer::HasStatus)
{
    busbar::detail::attempt([&] {
        const server::MethodCaller& caller = call.caller();
        std::vector<RecordField> fields{more.begin(), more.end()};
        fields.push_back({"ObjectId", Variant{call.object_id()}});
        if (refusal == nullptr || answer == MethodAnswer::HasStatus) {
            fields.push_back({"MethodId", Variant{call.method_id()}});
        }
        Record record{kind, refusal == nullptr ? LogLevel::Info : LogLevel::Warning,
                      "administration"};
        record.text = std::string{name(kind)} + " by user \"" + printable(caller.user.name) +
                      "\" from " + caller.address +
                      (refusal != nullptr ? ": " + text(*refusal) : std::string{});
        record.status = status;
        record.refusal = refusal;
        record.actor.session_id = &caller.session_id;
        record.actor.user = caller.user.name;
        record.actor.address = caller.address;
        record.actor.audit_entry_id = caller.audit_entry_id;
        record.actor.action_time = caller.action_time;
        record.certificate = certificate;
        record.fields = fields;
        tell(log, record);
    });
}

/// Answers the call with the status and reason of the refusal.
inline void answer_with(server::MethodCall& call, const Refusal& refusal)
{
    call.fail(refusal.status, reason_of(refusal));
}

/// Asks AdministrationParts::may_change_users; nothing if a change is allowed.
inline std::optional<Refusal> refusal_of(const std::function<Configured<void>()>& may_change)
{
    const auto may = may_change ? may_change() : Configured<void>{};
    return may ? std::nullopt
               : std::optional{
                     Refusal{may.error().status, "users and roles", may.error().text, {}, {}}};
}

} // namespace busbar::administration::detail
