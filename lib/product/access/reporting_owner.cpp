#include "reporting_owner.hpp"

#include <array>
#include <span>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

using administration::TransferRequest;

StatusCode ReportingOwner::allow()
{
    refusal_.clear();
    return status::Good;
}

StatusCode ReportingOwner::refuse(StatusCode status, std::string why)
{
    refusal_ = std::move(why);
    return status;
}

Result<std::vector<std::byte>> ReportingOwner::give(std::string_view text, std::size_t max_size)
{
    if (text.size() > max_size) {
        return fail(refuse(status::Bad_EncodingLimitsExceeded,
                           "it is larger than " + std::to_string(max_size) + " bytes"));
    }
    const auto bytes = std::as_bytes(std::span{text});
    return std::vector<std::byte>{bytes.begin(), bytes.end()};
}

Result<std::vector<std::byte>> ReportingOwner::give_report(const TransferRequest& request,
                                                           std::size_t max_size)
{
    if (report_.text.empty() || report_.session != request.session) {
        return fail(
            refuse(status::Bad_NotFound, "there is no report: this session has sent no file here"));
    }
    return give(report_.text, max_size);
}

StatusCode ReportingOwner::report(const TransferRequest& request,
                                  const Configured<std::string>& done, std::string_view verb)
{
    if (done) {
        // What was done is done, with a report or without the memory for one.
        report_.text.clear();
        busbar::detail::attempt([&] { report_ = Report{request.session, *done}; });
        return allow();
    }
    const StatusCode status = refuse(done.error().status, text(done.error()));
    detail::JsonWriter json;
    json.begin_object();
    json.name("problem");
    json.string(refusal_);
    json.end_object();
    report_ = {request.session, json.take()};
    if (!verb.empty()) {
        log_.write(LogLevel::Error, source_,
                   std::string{verb} + ": nothing was changed: " + refusal_);
    }
    return status;
}

void ReportingOwner::tell_changed(const TransferRequest& request, RecordKind kind) const
{
    std::array<RecordField, 1> method{RecordField{"MethodId", Variant{}}};
    if (request.method != nullptr) {
        busbar::detail::attempt([&] { method[0].value = Variant{*request.method}; });
    }
    busbar::detail::attempt([&] {
        Record record{.kind = kind, .source = source_};
        record.actor.session_id = &request.session;
        record.actor.user = request.user.name;
        record.fields = std::span{method}.first(request.method != nullptr ? 1 : 0);
        tell(log_, record);
    });
}

} // namespace busbar::product
