#include "project_service.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text_forms.hpp>

#include "core/json_writer.hpp"
#include "kept_project.hpp"
#include "product/access/part_rights.hpp"

namespace busbar::product {

using administration::TransferRequest;

namespace {

constexpr const char* project_source = "project";
/// The whole project stays in memory until its transfer ends.
constexpr std::size_t max_project_size = 128U << 20U;

constexpr const char* despite_labels = "update despite labels";
constexpr std::size_t most_labels_logged = 20;

constexpr const char* unknown_wish = "found an unknown option of a project";

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

bool is_update(std::string_view wish)
{
    return wish == "update" || wish == despite_labels;
}

/// Writes the report of a verification.
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

ProjectService::ProjectService(Needs needs)
    : ReportingOwner{project_source, needs.log}, needs_{std::move(needs)}
{
}

administration::TemporaryFileTransfer ProjectService::transfer()
{
    const PartRight& right = right_of(AdministeredPart::Project);
    return {.name = std::string{right.name},
            .owner = this,
            .limits = {.max_file_size = max_project_size,
                       .max_held = 2 * max_project_size,
                       .max_written = 1},
            .readers = nodes_of(right.see),
            .writers = nodes_of(right.change)};
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

/// Returns the file of the project in the store, or of the one that replaces it.
Configured<std::string> ProjectService::document() const
{
    const bool is_damaged = needs_.store.current() == nullptr && needs_.served != nullptr;
    return is_damaged ? controller::document_of(*needs_.served) : needs_.store.document();
}

Result<std::vector<std::byte>> ProjectService::generate(const TransferRequest& request,
                                                        std::size_t max_size)
{
    if (request.options.is_null()) {
        const auto text = document();
        return text ? give(*text, max_size)
                    : fail(refuse(text.error().status, busbar::text(text.error())));
    }
    const std::string wish = wish_of(request.options);
    return wish == "report"   ? give_report(request, max_size)
           : wish == "status" ? give(status_text(), max_size)
                              : fail(refuse(status::Bad_InvalidArgument, unknown_wish));
}

StatusCode ProjectService::may_take(const TransferRequest& request)
{
    const std::string wish = wish_of(request.options);
    if (wish != "write" && wish != "verify" && wish != "labels" && !is_update(wish)) {
        return refuse(status::Bad_InvalidArgument, unknown_wish);
    }
    if (wish != "write" && needs_.store.current() == nullptr) {
        return refuse(status::Bad_NotFound, "the controller has no project; write one before");
    }
    return allow();
}

std::function<void()> ProjectService::preparation(const TransferRequest& request,
                                                  std::span<const std::byte> bytes)
{
    const std::string wish = wish_of(request.options);
    if (wish == "labels" || is_update(wish)) {
        return [this] { labels_ = compare_labels(); };
    }
    if (wish == "write") {
        return [this, bytes] { staged_.emplace(std::as_const(needs_.store).stage(bytes)); };
    }
    return [this, bytes] { differences_ = compare(bytes, *needs_.store.current()); };
}

StatusCode ProjectService::take(const TransferRequest& request, std::span<const std::byte> bytes)
{
    // The state may have changed since the client began.
    if (const StatusCode may = may_take(request); may.is_bad()) {
        return may;
    }
    const std::string wish = wish_of(request.options);
    const auto done = wish == "write"    ? write(bytes)
                      : wish == "verify" ? std::exchange(differences_, {})
                      : wish == "labels" ? std::exchange(labels_, {}).transform(labels_report)
                                         : update(bytes, wish == despite_labels);
    return report(request, done, is_update(wish) ? "update" : wish);
}

Configured<std::string> ProjectService::write(std::span<const std::byte> bytes)
{
    auto staged = std::exchange(staged_, std::nullopt);
    if (!*staged) {
        return Unexpected{std::move(staged->error())};
    }
    // Allocate memory before the project is in the store.
    Configured<std::string> done{R"({"written":true})"};
    if (auto written = needs_.store.take_up(**std::move(staged)); !written) {
        return Unexpected{std::move(written.error())};
    }
    needs_.is_update_due = true;
    busbar::detail::attempt([&] {
        needs_.log.write(LogLevel::Info, project_source,
                         "a project was written: " + std::to_string(bytes.size()) + " bytes");
    });
    return done;
}

/// Runs on the worker.
Configured<std::vector<controller::LabelDifference>> ProjectService::compare_labels() const
{
    if (needs_.labels == nullptr) {
        return {};
    }
    return label_differences(*needs_.store.current(), *needs_.labels);
}

/// Decides whether the project may be used with its labels as they are.
Configured<void> ProjectService::take_labels(bool despite_labels)
{
    const auto labels = std::exchange(labels_, {});
    if (!labels) {
        return Unexpected{labels.error()};
    }
    const auto usable = check_usable(*labels);
    if (!usable && !despite_labels && !needs_.isolates_failures) {
        return usable;
    }
    if (!usable && despite_labels) {
        if (auto accepted = needs_.accept_labels(); !accepted) {
            return accepted;
        }
    }
    for (std::size_t i = 0; i < std::min(labels->size(), most_labels_logged); ++i) {
        needs_.log.write(LogLevel::Warning, project_source, controller::text((*labels)[i]));
    }
    if (labels->size() > most_labels_logged) {
        needs_.log.write(LogLevel::Warning, project_source,
                         std::to_string(labels->size()) + " labels in all differ from their nodes");
    }
    return {};
}

Configured<std::string> ProjectService::update(std::span<const std::byte> bytes,
                                               bool despite_labels)
{
    if (!bytes.empty()) {
        return misconfigured("update", "found a file, expected an empty one",
                             status::Bad_InvalidArgument);
    }
    Configured<std::string> done{R"({"updated":true})"};
    if (auto may = take_labels(despite_labels); !may) {
        return Unexpected{std::move(may.error())};
    }
    if (auto updated = needs_.update(); !updated) {
        return Unexpected{std::move(updated.error())};
    }
    return done;
}

} // namespace busbar::product
