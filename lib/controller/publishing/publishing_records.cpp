#include <busbar/controller/publishing.hpp>

#include <array>

#include <busbar/core/record.hpp>
#include <busbar/core/text.hpp>

namespace busbar::controller {

namespace {

constexpr std::array<std::string_view, 3> limit_names{"MaxVariables", "MaxValues", "MaxDataTypes"};
constexpr std::array<std::string_view, 3> limit_texts{"variables", "values",
                                                      "structure definitions"};

struct ReasonRow {
    std::string_view name;
    unsigned event_bit;
    std::string_view text;
};

/// Rows in the order of UnpublishedReason. Two reasons share a name in the execution log but have
/// separate bits in the event (W588, 7-1-6 and 9-2-2).
constexpr std::array reason_rows{
    ReasonRow{"MultiDimensionalArray", 0, "is an array of structures with several dimensions"},
    ReasonRow{"MultiDimensionalArray", 1, "has a member that is an array of several dimensions"},
    ReasonRow{"NestedStructre", 2, "has too many structures within one another"},
    ReasonRow{"Union", 3, "is or has a union"},
    ReasonRow{"SubscriptOfArray", 4, "is or has an array whose first index is not 0"},
    ReasonRow{"MaxArrayElements", 6, "has too many elements"},
    ReasonRow{"MaxMembers", 7, "is of a structure with too many members"},
    ReasonRow{"MaxSize", 5, "is too large"},
    ReasonRow{"Unserved", 8, {}},
};
static_assert(reason_rows.size() == static_cast<std::size_t>(UnpublishedReason::Unserved) + 1);

const ReasonRow& row_of(UnpublishedReason reason)
{
    return reason_rows[static_cast<std::size_t>(reason)];
}

Variant borrowed(std::string_view text)
{
    return Variant{String::borrow(text)};
}

void tell_record(LogSink& log, RecordKind kind, LogLevel level, std::string text,
                 std::span<const RecordField> fields)
{
    Record record;
    record.kind = kind;
    record.level = level;
    record.source = "publishing";
    record.text = std::move(text);
    record.fields = fields;
    tell(log, record);
}

/// Writes no log text, because there may be a hundred thousand variables.
void tell_published(LogSink& log, const PublishedVariable& published)
{
    const RecordField fields[] = {{"Name", borrowed(published.variable->name)},
                                  {"Size", Variant{published.size}},
                                  {"Values", Variant{published.values}},
                                  {"Members", Variant{published.members}}};
    tell_record(log, RecordKind::VariablePublished, LogLevel::Debug, {}, fields);
}

void tell_unpublished(LogSink& log, const UnpublishedVariable& one)
{
    const ReasonRow& row = row_of(one.reason);
    const RecordField fields[] = {{"Name", borrowed(one.variable->name)},
                                  {"Reason", borrowed(row.name)},
                                  {"Size", Variant{one.size}},
                                  {"ErrorDetails", Variant{event_bit(one.reason)}}};
    tell_record(log, RecordKind::VariableNotPublished, LogLevel::Warning,
                printable(one.variable->name) + " is not published: " +
                    (one.left_out == nullptr ? "it " : "") + reason_text(one),
                fields);
}

/// Records the variables from these positions on, in the order in which they were examined.
void tell_variables(LogSink& log, const Publication& publication, std::size_t first,
                    std::size_t first_unpublished)
{
    const auto& published = publication.published();
    const auto& unpublished = publication.unpublished();
    std::size_t next = first_unpublished;
    for (std::size_t i = first; i <= published.size(); ++i) {
        for (; next < unpublished.size() && unpublished[next].position == i; ++next) {
            tell_unpublished(log, unpublished[next]);
        }
        if (i < published.size()) {
            tell_published(log, published[i]);
        }
    }
}

void tell_limit(LogSink& log, std::size_t limit)
{
    const RecordField fields[] = {{"Limit", borrowed(limit_names[limit])}};
    tell_record(log, RecordKind::PublishingLimitExceeded, LogLevel::Warning,
                "not every variable is published: there are too many " +
                    std::string{limit_texts[limit]},
                fields);
}

void tell_counts(LogSink& log, const Publication& publication)
{
    const std::uint64_t variables = publication.published().size();
    const RecordField fields[] = {{"Variables", Variant{variables}},
                                  {"Values", Variant{publication.values()}},
                                  {"DataTypes", Variant{publication.data_types()}}};
    tell_record(log, RecordKind::VariablesCounted, LogLevel::Info,
                std::to_string(variables) + " variables are published, with " +
                    std::to_string(publication.values()) + " values and " +
                    std::to_string(publication.data_types()) + " structure definitions",
                fields);
}

} // namespace

std::string_view name(PublishingLimit limit)
{
    return limit_names[static_cast<std::size_t>(limit)];
}

std::string_view name(UnpublishedReason reason)
{
    return row_of(reason).name;
}

std::uint16_t event_bit(UnpublishedReason reason)
{
    return static_cast<std::uint16_t>(1U << row_of(reason).event_bit);
}

std::string reason_text(const UnpublishedVariable& variable)
{
    return variable.left_out != nullptr ? std::string{text(variable.left_out->problem)}
                                        : std::string{row_of(variable.reason).text} + " (" +
                                              std::to_string(variable.size) + " bytes)";
}

void tell(LogSink& log, const Publication& publication)
{
    tell_variables(log, publication, 0, 0);
    for (std::size_t limit = 0; limit < limit_names.size(); ++limit) {
        if (publication.exceeded()[limit]) {
            tell_limit(log, limit);
        }
    }
    tell_counts(log, publication);
}

void tell(LogSink& log, const Publication& publication, const PublicationGroup& group)
{
    tell_variables(log, publication, group.first_published, group.first_unpublished);
    if (group.exceeded) {
        tell_limit(log, static_cast<std::size_t>(*group.exceeded));
    }
    tell_counts(log, publication);
}

} // namespace busbar::controller
