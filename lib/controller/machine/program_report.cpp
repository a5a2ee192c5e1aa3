#include "program_report.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include <busbar/controller/text_encoding.hpp>
#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

using busbar::detail::JsonWriter;

void add_member(JsonWriter& json, const char* name, const std::string& text)
{
    json.name(name);
    json.string(text);
}

void add_member(JsonWriter& json, const char* name, std::uint64_t number)
{
    json.name(name);
    json.word(std::to_string(number));
}

/// A number of all variables together, and its limit.
struct Count {
    const char* name;
    const char* label;
    std::uint64_t count;
    std::optional<std::uint64_t> limit;
};

std::array<Count, 3> counts_of(const Publication& publication, const PublishingLimits& limits)
{
    return {
        Count{"variables", "variables      ", publication.published().size(), limits.max_variables},
        Count{"values", "values         ", publication.values(), limits.max_values},
        Count{"dataTypes", "structures     ", publication.data_types(), limits.max_data_types}};
}

std::string counted(std::uint64_t count, const char* what)
{
    return std::to_string(count) + " " + what;
}

} // namespace

ProgramReport::ProgramReport(std::string name,
                             Configured<std::shared_ptr<const CheckedProgram>> program,
                             const PublishingLimits& limits)
    : name_{std::move(name)}, limits_{limits}
{
    std::replace(name_.begin(), name_.end(), '\n', ' ');
    if (program) {
        program_ = PublishedProgram::create(*std::move(program), limits);
    } else {
        refusal_ = text(program.error());
    }
}

bool ProgramReport::is_good() const
{
    const auto is_part = [](const LeftOut& each) { return each.kind == LeftOut::Kind::Part; };
    return program_ != nullptr && program_->publication().unpublished().empty() &&
           program_->publication().left_out() == 0 &&
           std::none_of(program_->program().left_out.begin(), program_->program().left_out.end(),
                        is_part);
}

std::vector<std::string> ProgramReport::left_out() const
{
    std::vector<std::string> all;
    for (const LeftOut& each : program_->program().left_out) {
        if (each.kind != LeftOut::Kind::Unit && each.declared.publish == NetworkPublish::Hidden) {
            all.emplace_back(text(each.problem));
        }
    }
    return all;
}

std::string ProgramReport::exceeded() const
{
    std::string limits;
    for (const auto limit :
         {PublishingLimit::Variables, PublishingLimit::Values, PublishingLimit::DataTypes}) {
        if (program_->publication().exceeds(limit)) {
            limits = controller::name(limit);
        }
    }
    return limits;
}

std::vector<std::string> ProgramReport::lines() const
{
    if (program_ == nullptr) {
        return {name_ + " is refused: " + refusal_};
    }
    const Publication& publication = program_->publication();
    const std::vector<std::string> other = left_out();
    std::vector<std::string> all{
        name_ + ": " + counted(publication.published().size(), "variables are published with ") +
        counted(publication.values(), "values and ") +
        counted(publication.data_types(), "structure definitions; ") +
        counted(publication.unpublished().size() + publication.left_out(),
                "are not although they are to be; ") +
        counted(other.size(), "other declarations are left out")};
    all.push_back("  encoding       " +
                  std::string{controller::name(program_->program().encoding)});
    for (const Count& each : counts_of(publication, limits_)) {
        all.push_back("  " + std::string{each.label} + std::to_string(each.count) +
                      (each.limit ? " of " + std::to_string(*each.limit) : ", without a limit"));
    }
    for (const PublishedVariable& each : publication.published()) {
        all.push_back("  published      " + printable(each.variable->name) + "  " +
                      std::to_string(each.size) + " bytes");
    }
    for (const UnpublishedVariable& each : publication.unpublished()) {
        all.push_back("  not published  " + printable(each.variable->name) + "  " +
                      reason_text(each));
    }
    if (publication.left_out() != 0) {
        all.push_back("  not published  " + std::to_string(publication.left_out()) +
                      " more, because of the limit " + exceeded());
    }
    for (const std::string& each : other) {
        all.push_back("  left out       " + each);
    }
    return all;
}

void ProgramReport::write_variables(JsonWriter& json) const
{
    const Publication& publication = program_->publication();
    json.name("published");
    json.begin_list();
    for (const PublishedVariable& each : publication.published()) {
        json.begin_object();
        add_member(json, "name", each.variable->name);
        add_member(json, "size", each.size);
        add_member(json, "values", each.values);
        json.end_object();
    }
    json.end_list();
    json.name("notPublished");
    json.begin_list();
    for (const UnpublishedVariable& each : publication.unpublished()) {
        json.begin_object();
        add_member(json, "name", each.variable->name);
        add_member(json, "reason", std::string{controller::name(each.reason)});
        add_member(json, "text", reason_text(each));
        json.end_object();
    }
    json.end_list();
}

void ProgramReport::write(JsonWriter& json) const
{
    json.begin_object();
    add_member(json, "file", name_);
    if (program_ == nullptr) {
        add_member(json, "refused", refusal_);
        json.end_object();
        return;
    }
    const Publication& publication = program_->publication();
    add_member(json, "encoding", std::string{controller::name(program_->program().encoding)});
    add_member(json, "values", publication.values());
    add_member(json, "dataTypes", publication.data_types());
    add_member(json, "exceeded", exceeded());
    add_member(json, "beyondLimit", publication.left_out());
    json.name("counts");
    json.begin_list();
    for (const Count& each : counts_of(publication, limits_)) {
        json.begin_object();
        add_member(json, "name", std::string{each.name});
        add_member(json, "count", each.count);
        json.name("limit");
        json.word(each.limit ? std::to_string(*each.limit) : "null");
        json.end_object();
    }
    json.end_list();
    write_variables(json);
    json.name("leftOut");
    json.begin_list();
    for (const std::string& each : left_out()) {
        json.string(each);
    }
    json.end_list();
    json.end_object();
}

} // namespace busbar::controller::detail
