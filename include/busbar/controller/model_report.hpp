#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>

/// Reports about information models and their mapping, as listed in the output window of a
/// configuration tool (SH-082679, 4.2).
namespace busbar::controller {

/// The severity of a report.
enum class ReportResult : std::uint8_t {
    Error,   // the operation failed, or cannot be served as intended
    Warning, // should be checked
};

/// Our own codes; a code never changes its meaning or number. The hundreds: 1 model files, 2
/// mapping in files, 3 mapping and nodes, 4 limits, 5 mapping tables.
enum class ModelCode : std::uint16_t {
    FileUnreadable = 101,
    FileInvalid = 102,
    FileNote = 103,
    SeveralNamespaces = 104,
    NoNamespace = 105,
    ModelMissing = 106,
    ModelOfOtherVersion = 107,
    NamespaceUnknown = 108,
    NotUndermost = 109,
    StandardNamespace = 110,
    DependentInvalid = 111,
    FileRepaired = 112,

    ElementUnknown = 201,
    AttributeUnknown = 202,
    AttributeMissing = 203,
    AttributeInvalid = 204,
    ValueOmitted = 205,
    LabelMisplaced = 206,
    FormatInvalid = 207,
    NamespaceMisplaced = 208,
    WrongNodeClass = 209,
    ChangedElsewhere = 210,
    MappingRepeated = 211,
    TooManyParts = 212,

    NodeMissing = 301,
    StandardNode = 302,
    NotBelowObjects = 303,
    BelowServer = 304,
    BelowAliases = 305,
    RequiredNamespace = 306,
    ArgumentsProperty = 307,
    NotAssignable = 308,
    PartUnknown = 309,
    PartRepeated = 310,
    SpecificationInvalid = 311,
    SpecificationUnused = 312,
    LabelNotHere = 313,
    LabelInvalid = 314,
    MappingDropped = 315,
    AttributesChanged = 316,
    ArgumentUnknown = 317,
    TypeUnsupported = 318,
    MethodHasOutputs = 319,
    LabelUnavailable = 320,
    LabelOfWrongType = 321,
    LabelConverted = 322,
    ScalingInvalid = 323,
    QualityAlone = 324,
    RoleUnknown = 325,
    RightUnused = 326,
    RolesKept = 327,
    RolesReplaced = 328,

    TooManyFiles = 401,
    FilesTooLarge = 402,
    TooManyNamespaces = 403,
    UriTooLong = 404,
    TooManyNodes = 405,
    TooManyVariables = 406,
    VariablesTooLarge = 407,
    TooManyNodeLevels = 408,
    TooManyStructureLevels = 409,
    TooManyElements = 410,
    TooManyLabels = 411,
    LabelTooLong = 412,
    LabelsTooLong = 413,

    TableInvalid = 501,
    TableTooLarge = 502,
    TableHeader = 503,
    TableNode = 504,
    TablePart = 505,
    TableNumber = 506,
    TableRepeated = 507,
    TableScaling = 508,
    TableRoles = 509,
};

/// The properties common to all reports with a code; constant texts.
struct ReportRule {
    ModelCode code;
    ReportResult result;
    /// "Import", "Export", "Mapping", "Namespace": the function that found it.
    std::string_view function;
    /// The operation or setting that caused it.
    std::string_view category;
    std::string_view content;
    std::string_view corrective_action;
};

/// Returns one rule for each code, in ascending order.
[[nodiscard]] BUSBAR_API std::span<const ReportRule> report_rules();
/// `code` must be one of ModelCode.
[[nodiscard]] BUSBAR_API const ReportRule& rule_of(ModelCode code);

/// One line of the output window.
struct ModelReport {
    ModelCode code{};
    /// Null if it concerns no node.
    NodeId node{};
    /// File, line, node and part as far as they are known: "cell.xml: ns=1;i=5: [2].Speed".
    std::string where{};
    /// The finding. Printable, since it may contain text of a file.
    std::string found{};

    friend bool operator==(const ModelReport&, const ModelReport&) = default;
};

/// Returns "error M203 cell.xml: ns=1;i=5: An attribute is missing: Num. Write the attribute.", for
/// example.
[[nodiscard]] BUSBAR_API std::string text(const ModelReport& report);

/// Reports in the order in which they were found, up to a maximum number: beyond it they are only
/// counted, since every line of a file may have an error.
class BUSBAR_API ModelReports {
public:
    static constexpr std::size_t max_kept = 1'000;

    /// Counts the report, and keeps it if there are fewer than `max_kept`.
    void add(ModelReport report);
    /// Adds all of them.
    void add(ModelReports&& others);

    [[nodiscard]] const std::vector<ModelReport>& list() const { return list_; }
    /// Includes those that were not kept.
    [[nodiscard]] std::size_t error_count() const { return error_count_; }
    [[nodiscard]] std::size_t warning_count() const { return warning_count_; }
    [[nodiscard]] bool has_errors() const { return error_count_ != 0; }
    [[nodiscard]] bool is_empty() const { return error_count_ + warning_count_ == 0; }

private:
    std::vector<ModelReport> list_;
    std::size_t error_count_{0};
    std::size_t warning_count_{0};
};

} // namespace busbar::controller
