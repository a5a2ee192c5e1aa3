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

/// The information models of a project (seed 001, 9.4 and 9.6). Of the target busbar::model_mode,
/// which needs pugixml.
namespace busbar::controller {

/// Whether a RequiredModel is there (seed 001, 9.6). A missing one is refused at import.
enum class ModelState : std::uint8_t { Imported, OtherVersion };

struct RequiredModelStatus {
    std::string uri;
    /// What is asked for.
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
    /// OtherVersion if one of `required` is.
    ModelState state{ModelState::Imported};
    std::vector<RequiredModelStatus> required;

    friend bool operator==(const ModelNamespace&, const ModelNamespace&) = default;
};

/// A file of the project as it was imported.
struct ModelFile {
    std::string uri;
    /// For messages.
    std::string name;
    /// XML; its mapping is that of the import, ModelSet::mapping() the one that counts.
    std::string text;
};

struct ImportResult {
    /// The namespace that was imported.
    std::string uri;
    std::size_t node_count{0};
    /// It was there before and has been replaced.
    bool is_replacement{false};
    /// Warnings, and errors of mapping, which keep no model from being imported.
    ModelReports reports;
};

/// The information model files of a project, one namespace each, an AddressSpace of them, and what
/// is mapped. An operation that fails changes nothing.
///
/// An AddressSpace never loses types, so each change of the files makes a new one: references to
/// space() and extras() end then. One thread at a time.
class BUSBAR_API ModelSet {
public:
    /// The AddressSpace has `application_uri`, unless it is empty, as namespace 1, as that of a
    /// server.
    explicit ModelSet(const ModelLimits& limits = {}, std::string application_uri = {});
    ModelSet(ModelSet&&) noexcept;
    ModelSet& operator=(ModelSet&&) noexcept;
    ~ModelSet();

    /// Adds a file of one namespace, or replaces the file of that namespace in its place. All its
    /// RequiredModels must have been imported; another version than the one asked for is a warning.
    ///
    /// Of the mapping (seed 001, 9.4): what the file has of a node replaces what was there; where
    /// it has none, what was there stays. It goes where the node is gone, and where its NodeClass
    /// has become another one than Variable.
    ///
    /// Takes time in proportion to the file if its namespace is a new one, else to all of them.
    /// The error has at least one report of ReportResult::Error.
    [[nodiscard]] Expected<ImportResult, ModelReports> import(const model::NodeSetSource& source);

    /// Takes away the last namespace of the list and its mapping (seed 001, 9.6). NotUndermost for
    /// another one, StandardNamespace for namespace 0, NamespaceUnknown.
    [[nodiscard]] Expected<void, ModelReport> remove(std::string_view uri);

    /// The nodes of one namespace with their mapping as a file, which import() reads as the same.
    /// NamespaceUnknown, also for namespace 0 and that of the application.
    [[nodiscard]] Expected<std::string, ModelReport> export_text(std::string_view uri) const;

    /// The same of all files(), in their order; mapped parts and nodes are gone through once.
    [[nodiscard]] std::vector<std::string> export_texts() const;

    /// In the order of NamespaceIndex; the first is OPC UA's own.
    [[nodiscard]] const std::vector<ModelNamespace>& namespaces() const;
    /// In the order of import, by which each comes behind what it requires.
    [[nodiscard]] const std::vector<ModelFile>& files() const;
    [[nodiscard]] const model::AddressSpace& space() const;
    [[nodiscard]] const model::NodeSetExtras& extras() const;
    [[nodiscard]] const ModelLimits& limits() const;
    /// By NodeIds of space().
    [[nodiscard]] const Mapping& mapping() const;
    /// For changes; check_mapping tells whether they make sense.
    [[nodiscard]] Mapping& mapping();
    /// Bytes of all files.
    [[nodiscard]] std::uint64_t file_size() const;

    /// Adds the nodes to the AddressSpace of a server. Returns the mapping by the NodeIds that they
    /// have there; `space` is as before if there is a problem.
    [[nodiscard]] Expected<Mapping, ModelReports> load_into(model::AddressSpace& space) const;

private:
    struct State;
    struct Change;

    std::unique_ptr<State> state_;
};

/// The name of a file for an exported namespace, without ".xml" (seed 001, 9.4): what is behind the
/// last slash of the URI, without what file systems do not take (appendix 6). "_1", "_2" and so on
/// come behind a name that is in `taken`, whatever its case, and stand for one that is empty or
/// reserved.
[[nodiscard]] BUSBAR_API std::string default_file_name(std::string_view uri,
                                                       const std::vector<std::string>& taken = {});

} // namespace busbar::controller
