#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/model/nodeset.hpp>

/// The information models of a project (SH-082679, 9.4 and 9.6). In the target
/// busbar::model_mode, which needs pugixml.
namespace busbar::controller {

/// The state of a RequiredModel (SH-082679, 9.6). An import with a missing one is refused.
enum class ModelState : std::uint8_t {
    Imported,
    /// Later than required, which has all that the required one has.
    LaterVersion,
    /// Earlier than required, or neither earlier nor later, so that nodes may be missing.
    OtherVersion
};

/// A model that another one requires, and whether it is there.
struct RequiredModelStatus {
    std::string uri;
    /// The required version.
    std::string version;
    std::string publication_date;
    ModelState state{ModelState::Imported};

    friend bool operator==(const RequiredModelStatus&, const RequiredModelStatus&) = default;
};

/// A line of the NamespaceArray window, with the RequiredModel window below it.
struct ModelNamespace {
    std::uint16_t index{0};
    std::string uri;
    std::string version;
    std::string publication_date;
    /// That of the worst one of `required`.
    ModelState state{ModelState::Imported};
    std::vector<RequiredModelStatus> required;

    friend bool operator==(const ModelNamespace&, const ModelNamespace&) = default;
};

/// A file of the project as it was imported.
struct ModelFile {
    std::string uri;
    /// For messages.
    std::string name;
    /// XML as it was imported; the present mapping and roles are those of the ModelSet.
    std::string text;
    /// See model::NodeSetSource.
    bool is_lenient{false};
};

/// The result of an import.
struct ImportResult {
    /// The namespace that was imported.
    std::string uri;
    std::size_t node_count{0};
    /// It existed before and has been replaced.
    bool is_replacement{false};
    /// Warnings, and errors of mapping, which do not prevent an import.
    ModelReports reports;
    /// Counts the repairs of a lenient source, a line for each rule; each repair is in `reports`.
    std::vector<std::string> repairs{};
};

/// The information model files of a project, one namespace each, with an AddressSpace of them and
/// the mapping. An operation that fails changes nothing.
///
/// Types cannot be removed from an AddressSpace, so each change of the files creates a new one:
/// references to space() and extras() become invalid. One thread at a time.
class BUSBAR_API ModelSet {
public:
    /// The AddressSpace has `application_uri`, unless it is empty, as namespace 1, like that of a
    /// server.
    explicit ModelSet(const ModelLimits& limits = {}, std::string application_uri = {});
    ModelSet(ModelSet&&) noexcept;
    ModelSet& operator=(ModelSet&&) noexcept;
    ~ModelSet();

    /// Adds a file of one namespace, or replaces the existing file of that namespace. All its
    /// RequiredModels must have been imported; an earlier one than required is a warning. A lenient
    /// source is repaired; export_text() has it as repaired.
    ///
    /// Mapping (SH-082679, 9.4): a node's mapping in the file replaces the existing one;
    /// if the file has none for a node, the existing one is kept. It is removed if the node is
    /// gone, or if its NodeClass is no longer Variable. RolePermissions likewise: a node that has
    /// some in the project and none in the file keeps them.
    ///
    /// Takes time in proportion to the file if its namespace is new, otherwise to all files. The
    /// error has at least one report with ReportResult::Error.
    [[nodiscard]] Expected<ImportResult, ModelReports> import(const model::NodeSetSource& source);

    /// Removes the last namespace of the list and its mapping (SH-082679, 9.6).
    /// NotUndermost for another one, StandardNamespace for namespace 0, NamespaceUnknown.
    [[nodiscard]] Expected<void, ModelReport> remove(std::string_view uri);

    /// Returns the nodes of one namespace with their mapping as a file, which import() reads as the
    /// same. NamespaceUnknown, also for namespace 0 and that of the application.
    [[nodiscard]] Expected<std::string, ModelReport> export_text(std::string_view uri) const;

    /// Exports all files(), in their order; visits mapped parts and nodes only once.
    [[nodiscard]] std::vector<std::string> export_texts() const;

    /// In the order of NamespaceIndex; the first is that of OPC UA.
    [[nodiscard]] const std::vector<ModelNamespace>& namespaces() const;
    /// In the order of import: each file comes after those that it requires.
    [[nodiscard]] const std::vector<ModelFile>& files() const;
    [[nodiscard]] const model::AddressSpace& space() const;
    [[nodiscard]] const model::NodeSetExtras& extras() const;
    [[nodiscard]] const ModelLimits& limits() const;
    /// Keyed by NodeIds of space().
    [[nodiscard]] const Mapping& mapping() const;
    /// For changes; check_mapping tells whether they are valid.
    [[nodiscard]] Mapping& mapping();
    /// Sets the RolePermissions of a node of a model; null: those of its namespace apply, if there
    /// are any. The file that has the node has them, too, when it is exported.
    void set_roles(model::NodeIndex node, Array<RolePermissionType> roles);
    /// Bytes of all files.
    [[nodiscard]] std::uint64_t file_size() const;

    /// Adds the nodes to the AddressSpace of a server. Returns the mapping with the NodeIds that
    /// they have there; `space` is unchanged if there is a problem.
    [[nodiscard]] Expected<Mapping, ModelReports> load_into(model::AddressSpace& space) const;

private:
    struct State;
    struct Change;

    std::unique_ptr<State> state_;
};

/// Returns the name of a file for an exported namespace, without ".xml" (manual of model mode,
/// 9.4): the part after the last slash of the URI, without characters that file systems do not
/// accept (appendix 6). "_1", "_2" and so on are appended to a name that is in `taken`, ignoring
/// case, and are used instead of an empty or reserved name.
[[nodiscard]] BUSBAR_API std::string default_file_name(std::string_view uri,
                                                       const std::vector<std::string>& taken = {});

} // namespace busbar::controller
