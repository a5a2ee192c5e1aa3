#include "project_service.hpp"

#include <string_view>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/types/ids.hpp>

#include "core/json_writer.hpp"

namespace busbar::product {

using administration::TransferRequest;

namespace {

constexpr const char* project_source = "project";
/// The whole project is in memory until its transfer is over.
constexpr std::size_t max_project_size = 128U << 20U;

struct Member {
    std::string_view name;
    std::string_view text;
};

void write_object(detail::JsonWriter& json, std::initializer_list<Member> members)
{
    json.begin_object();
    for (const Member& member : members) {
        json.name(member.name);
        json.string(member.text);
    }
    json.end_object();
}

std::string differences_report(const std::vector<controller::ProjectDifference>& differences)
{
    detail::JsonWriter json;
    json.begin_object();
    json.name("differences");
    json.begin_list();
    for (const controller::ProjectDifference& each : differences) {
        write_object(json, {{"where", each.where}, {"file", each.first}, {"server", each.second}});
    }
    json.end_list();
    json.end_object();
    return json.take();
}

/// The report of a verification.
Configured<std::string> compare(std::span<const std::byte> bytes, const controller::Project& server)
{
    const auto file = controller::read_project(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "project");
    if (!file) {
        return Unexpected{file.error()};
    }
    auto differences = controller::setting_differences(*file, server);
    const auto models = controller::model_differences(*file, server);
    differences.insert(differences.end(), models.begin(), models.end());
    return differences_report(differences);
}

std::string wish_of(const Variant& options)
{
    const auto* const text = options.get_if<String>();
    return text != nullptr ? std::string{text->view()} : std::string{};
}

} // namespace

ProjectService::ProjectService(Needs needs) : needs_{std::move(needs)} {}

administration::TemporaryFileTransfer ProjectService::transfer()
{
    // A project has users, their hashes and who may come without security: none but who may change
    // these may read or write it.
    const std::vector<NodeId> administrators{NodeId{0, id::WellKnownRole_SecurityAdmin}};
    return {.name = "Project",
            .owner = this,
            .limits = {.max_file_size = max_project_size,
                       .max_held = 2 * max_project_size,
                       .max_written = 1},
            .readers = administrators,
            .writers = administrators};
}

std::string ProjectService::status_text() const
{
    const ModuleStatus status = needs_.status();
    detail::JsonWriter json;
    write_object(json, {{"operationMode", status.operation_mode},
                        {"serverStatus", status.server_status},
                        {"version", status.version},
                        {"project", project_state()}});
    return json.take();
}

std::string ProjectService::project_state() const
{
    if (needs_.store.current() != nullptr) {
        return needs_.is_update_due ? "written, an update or restart is due" : "in use";
    }
    if (needs_.damage.empty()) {
        return "none";
    }
    return std::string{"damaged, "} +
           (needs_.served != nullptr ? "the one that was served last is in use: "
                                     : "none is in use: ") +
           needs_.damage;
}

Result<std::string> ProjectService::text_of(const TransferRequest& request) const
{
    if (request.options.is_null()) {
        const bool is_damaged = needs_.store.current() == nullptr && needs_.served != nullptr;
        auto document =
            is_damaged ? controller::document_of(*needs_.served) : needs_.store.document();
        return document ? Result<std::string>{*std::move(document)} : fail(document.error().status);
    }
    const std::string wish = wish_of(request.options);
    if (wish == "status") {
        return status_text();
    }
    if (wish != "report") {
        return fail(status::Bad_InvalidArgument);
    }
    if (report_.text.empty() || report_.session != request.session) {
        return fail(status::Bad_NotFound);
    }
    return report_.text;
}

Result<std::vector<std::byte>> ProjectService::generate(const TransferRequest& request,
                                                        std::size_t max_size)
{
    const auto text = text_of(request);
    if (!text) {
        refusal_ = text.error() == status::Bad_NotFound
                       ? "there is no project, or no report of one that this session has sent"
                       : "found none of a project's options";
        return fail(text.error());
    }
    if (text->size() > max_size) {
        refusal_ = "the project is larger than " + std::to_string(max_size) + " bytes";
        return fail(status::Bad_EncodingLimitsExceeded);
    }
    const auto bytes = std::as_bytes(std::span{*text});
    return std::vector<std::byte>{bytes.begin(), bytes.end()};
}

StatusCode ProjectService::may_take(const TransferRequest& request)
{
    const std::string wish = wish_of(request.options);
    const bool is_known = wish == "write" || wish == "verify" || wish == "update";
    refusal_ = is_known ? "" : "found none of a project's options";
    if (!is_known) {
        return status::Bad_InvalidArgument;
    }
    if (wish != "write" && needs_.store.current() == nullptr) {
        refusal_ = "the controller has no project; write one before";
    }
    return refusal_.empty() ? status::Good : status::Bad_NotFound;
}

std::function<void()> ProjectService::preparation(const TransferRequest& request,
                                                  std::span<const std::byte> bytes)
{
    const std::string wish = wish_of(request.options);
    if (wish == "update") {
        return {};
    }
    if (wish == "write") {
        return [this, bytes] { staged_.emplace(std::as_const(needs_.store).stage(bytes)); };
    }
    return [this, bytes] { differences_ = compare(bytes, *needs_.store.current()); };
}

StatusCode ProjectService::take(const TransferRequest& request, std::span<const std::byte> bytes)
{
    // Things may have changed since the client began.
    if (const StatusCode may = may_take(request); may.is_bad()) {
        return may;
    }
    const std::string wish = wish_of(request.options);
    const auto done = wish == "write"    ? write(bytes)
                      : wish == "verify" ? std::exchange(differences_, {})
                                         : update(bytes);
    if (done) {
        report_ = {request.session, *done};
        return status::Good;
    }
    detail::JsonWriter json;
    refusal_ = text(done.error());
    write_object(json, {{"problem", refusal_}});
    report_ = {request.session, json.take()};
    needs_.log.write(LogLevel::Error, project_source, wish + ": nothing was changed: " + refusal_);
    return done.error().status;
}

Configured<std::string> ProjectService::write(std::span<const std::byte> bytes)
{
    auto staged = std::exchange(staged_, std::nullopt);
    if (!*staged) {
        return Unexpected{std::move(staged->error())};
    }
    if (auto written = needs_.store.take_up(**std::move(staged)); !written) {
        return Unexpected{std::move(written.error())};
    }
    needs_.is_update_due = true;
    needs_.log.write(LogLevel::Info, project_source,
                     "a project was written: " + std::to_string(bytes.size()) + " bytes");
    return std::string{R"({"written":true})"};
}

Configured<std::string> ProjectService::update(std::span<const std::byte> bytes)
{
    if (!bytes.empty()) {
        return misconfigured("update", "found a file, expected an empty one",
                             status::Bad_InvalidArgument);
    }
    if (auto updated = needs_.update(); !updated) {
        return Unexpected{std::move(updated.error())};
    }
    return std::string{R"({"updated":true})"};
}

} // namespace busbar::product
