#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_conversion.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/controller/value_shape.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/server/data_source.hpp>

/// Variables and Methods whose values are labels of a PLC: the data input/output function of model
/// mode (SH-082679, 8.1 and 8.3).
namespace busbar::controller {

namespace detail {
class MappedCore;
} // namespace detail

/// A Variable with labels. One without labels does not belong to a MappedSource: the AddressSpace
/// keeps it.
struct MappedVariable {
    NodeId node{};
    /// Null for a Variable of an unsupported type: it answers Bad_NotSupported to everything, as
    /// does one that has a label for a value that cannot have one.
    std::shared_ptr<const ValueShape> shape{};
    /// The label of each leaf of the shape; empty if there is none: that part keeps the value
    /// written to it last.
    std::vector<std::string> labels{};
    /// A value of the shape; if null, or of another shape: zeros.
    Variant initial{};
    /// True with CurrentRead. A Variable without it is not sampled in each scan.
    bool is_readable{true};
    /// The label of its quality, like DataMapping::quality. There is no value while it is bad.
    std::string quality{};
    /// The scaling of all labels of the value, with both ranges; if not set, they are not scaled.
    Scaling scaling{};
};

/// One of a Method's InputArguments.
struct MappedArgument {
    /// Null for an unsupported type, whose value is then refused if it has a label.
    std::shared_ptr<const ValueShape> shape{};
    /// Empty, or like MappedVariable::labels. A value without label is ignored in a Call.
    std::vector<std::string> labels{};
};

/// A Method whose calls are signaled to a program by bit 0 of its Handle.
struct MappedMethod {
    NodeId node{};
    /// The Handle's label; empty: a Call answers Bad_NotImplemented.
    std::string handle{};
    /// The InputArguments, from the first on; those after the last one here have no labels.
    std::vector<MappedArgument> arguments{};
    /// A Call answers Bad_NotSupported, and nothing is written (SH-082679, 2.1, note 4).
    bool has_outputs{false};
    /// Like MethodMapping::done; a Call waits for it, at most MappedOptions::call_limit.
    std::string done{};
    /// All OutputArguments, if there is a `done`. Those without a label are zero.
    std::vector<MappedArgument> outputs{};
};

/// The way in which values are collected (9.12).
enum class SamplingMode : std::uint8_t {
    /// Every read and every sample requests the value from the PLC.
    Standard,
    /// MonitoredItems get the values that the newest scan sampled, Reads request them from the PLC.
    MonitoredItems,
    /// Both get the values that the newest scan sampled.
    AllVariables,
};

/// Limits what one request of a client may request from the PLC; beyond them its nodes answer
/// Bad_NoCommunication (2.1, OPC UA communication specifications, note 3).
struct MappedLimits {
    /// Labels, "units of mapped data".
    std::size_t max_labels{4'000'000};
    /// Words of 16 bits that they occupy.
    std::size_t max_words{std::size_t{64} << 20U};
    /// Maximum size of all MonitoredItems in bytes (8.1, CreateMonitoredItems); beyond it they
    /// answer Bad_TooManyMonitoredItems.
    std::size_t max_monitored_size{std::size_t{1} << 30U};

    /// 25,000 units, 2,048K words, and as many bytes as those words for MonitoredItems.
    [[nodiscard]] static constexpr MappedLimits rd81opc96()
    {
        constexpr std::size_t words = std::size_t{2'048} << 10U;
        return {25'000, words, 2 * words};
    }
};

/// The options of a MappedSource.
struct MappedOptions {
    SamplingMode sampling{SamplingMode::Standard};
    MappedLimits limits{};
    ConversionOptions conversion{};
    /// A label that cannot be used, or whose value its node cannot hold, fails only the Variables
    /// and Methods that it belongs to; otherwise it fails all of them, or the whole request (8.3).
    bool isolates_failures{false};
    /// Maximum number of times an operation is repeated because the labels changed meanwhile.
    unsigned max_repetitions{3};
    /// The time that a Call waits for its Done, by the PLC's clock; after it the Call answers
    /// Bad_Timeout, and later results are dropped. Shorter than `timeout`.
    std::chrono::milliseconds call_limit{4'000};
    /// Like DataSourceOptions::timeout.
    std::chrono::milliseconds timeout{5'000};
    std::size_t max_batches{256};
    std::size_t max_items{4'000'000};
};

/// Event codes for the update of labels' addresses and types (8.3).
enum class LabelUpdate : std::uint16_t { Started = 24'000, Finished = 24'001, Failed = 24'003 };

/// Error codes (8.3).
enum class MappedErrorCode : std::uint16_t {
    Unavailable = 0x1921,         // the label does not exist or cannot be used
    WrongType = 0x1A00,           // the label's type does not fit the node
    OutOfRange = 0x1A01,          // the node cannot hold the label's value
    TooManyPoints = 0x1941,       // too many to sample in each scan
    UnsampledDevice = 0x1945,     // the label is on a device that cannot be sampled
    SamplingUnsupported = 0x1946, // the PLC does not sample in each scan
};

/// An error of the module, and what it concerns.
struct MappedError {
    MappedErrorCode code;
    /// Empty, and the node null, if an error concerns no particular one.
    std::string_view label{};
    const NodeId* node{nullptr};
};

/// Records events and errors. Called on the server's thread, within calls of the MappedSource; must
/// not call it.
class BUSBAR_API MappedObserver {
public:
    MappedObserver() = default;
    MappedObserver(const MappedObserver&) = delete;
    MappedObserver& operator=(const MappedObserver&) = delete;
    virtual ~MappedObserver() = default;

    /// Called when an update of the labels has started, has finished or has failed.
    virtual void label_update(LabelUpdate event) = 0;
    /// The references in the argument are valid until it returns.
    virtual void error(const MappedError& error) = 0;
};

/// Whether the PLC can be reached, according to the last request to it.
enum class TargetStatus : std::uint8_t { Unknown, Communicating, Failing };

/// A DataSource for the Variables and Methods that are mapped to labels of one PLC.
///
/// One request of a client is one request to the PLC, or several in a row for a Call, and its nodes
/// succeed or fail together; so do the MonitoredItems of one interval. Their source timestamp is
/// the PLC's time at completion. If labels are no longer those that were resolved, all of them are
/// resolved again and the request is repeated; requests that arrive meanwhile wait, except that
/// MonitoredItems have their last values with Good_Overload (10.3). Labels that cannot be resolved
/// or are of a wrong type make all mapped nodes answer Bad_NoCommunication (8.3) until labels
/// change and the next request finds them valid.
///
/// A Write with an IndexRange answers Bad_WriteNotSupported. If the PLC refuses because it is
/// overloaded or stops, and if there are more requests than the options allow, the ServiceResult is
/// Bad_TooManyOperations or Bad_Shutdown, see DataSourceOptions::decides_services; for a Call only
/// Bad_Shutdown (8.1).
///
/// For the server's thread, like any DataSource; the PLC may answer on any thread, which then only
/// queues the answer. Server, source and requests may end in any order.
class BUSBAR_API MappedSource final : public server::DataSource {
public:
    /// `backend`, not null, has no other listener from start() to stop(). `observer` may be null;
    /// it must outlive this object.
    explicit MappedSource(std::shared_ptr<backend::LabelBackend> backend,
                          const MappedOptions& options = {}, MappedObserver* observer = nullptr);
    ~MappedSource() override;

    // Before start().

    /// Returns the handle of the node, for AddressSpace::bind. Labels beyond the shape's leaves are
    /// ignored.
    [[nodiscard]] std::uint64_t add(MappedVariable variable);
    [[nodiscard]] std::uint64_t add(MappedMethod method);
    /// Lets Calls detect that their object is an ObjectType (Bad_NotSupported); `space` must
    /// outlive the source's calls. Without it, that is not detected.
    void set_space(const model::SpaceReader* space);

    /// Resolves all labels once the nodes exist: before that, they answer Bad_NoCommunication. A
    /// later call resolves them again. Does nothing without labels.
    void start();
    /// Releases the backend, which may then get another source as listener: pending requests answer
    /// Bad_NoCommunication, and so do all later ones until start().
    void stop();

    // The values in buffer memory that the manual names.

    /// Label update running status (`Un\G8617`).
    [[nodiscard]] bool is_updating() const;
    /// Status of target device 1 (`Un\G8448`).
    [[nodiscard]] TargetStatus target_status() const;

    [[nodiscard]] server::DataSourceOptions options() const override;
    void read(server::ReadBatch batch) override;
    void write(server::WriteBatch batch) override;
    void call(server::CallBatch batch) override;
    /// Bytes by the table of 8.1; Bad_NotSupported for an unsupported Variable.
    [[nodiscard]] Result<std::size_t> monitored_size(std::uint64_t handle) const override;
    void monitoring_changed(std::span<const server::Monitoring> changes) override;
    void attach(server::Waker* waker) override;
    void handle_completions() override;

private:
    std::unique_ptr<detail::MappedCore> core_;
};

} // namespace busbar::controller
