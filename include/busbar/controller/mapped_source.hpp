#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/label_conversion.hpp>
#include <busbar/controller/value_shape.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/server/data_source.hpp>

/// Variables and Methods whose values are labels of a PLC: the data input/output function of model
/// mode (seed 001, 8.1 and 8.3).
namespace busbar::controller {

namespace detail {
class MappedCore;
} // namespace detail

/// A Variable with labels. One without any is none of a MappedSource's: the AddressSpace keeps it.
struct MappedVariable {
    NodeId node{};
    /// Null for a Variable of an unsupported type: it answers Bad_NotSupported to everything, as
    /// does one with a label for a value that no label can have.
    std::shared_ptr<const ValueShape> shape{};
    /// The label of each leaf of the shape; empty where there is none, and that part keeps what was
    /// written to it last.
    std::vector<std::string> labels{};
    /// Of the shape; null, or of another shape: zeros.
    Variant initial{};
    /// Has CurrentRead. Without it, a Variable is not sampled in each scan.
    bool is_readable{true};
};

/// One of a Method's InputArguments.
struct MappedArgument {
    /// Null for an unsupported type, whose value is then refused if it has a label.
    std::shared_ptr<const ValueShape> shape{};
    /// Empty, or as MappedVariable::labels. What has no label is ignored in a Call.
    std::vector<std::string> labels{};
};

/// A Method that a program is told of by bit 0 of its Handle.
struct MappedMethod {
    NodeId node{};
    /// The Handle's label; empty: a Call answers Bad_NotImplemented.
    std::string handle{};
    /// Of the InputArguments, from the first on; those behind the last one here have no labels.
    std::vector<MappedArgument> arguments{};
    /// A Call answers Bad_NotSupported, and nothing is written (seed 001, 2.1, note 4).
    bool has_outputs{false};
};

/// How values are collected (9.12).
enum class SamplingMode : std::uint8_t {
    /// Whatever is read or sampled is asked of the PLC then.
    Standard,
    /// MonitoredItems get what the newest scan sampled, Reads ask the PLC.
    MonitoredItems,
    /// Both get what the newest scan sampled.
    AllVariables,
};

/// What one request of a client may ask of the PLC; past it, its nodes answer Bad_NoCommunication
/// (2.1, OPC UA communication specifications, note 3).
struct MappedLimits {
    /// Labels, "units of mapped data".
    std::size_t max_labels{4'000'000};
    /// Words of 16 bits that they take.
    std::size_t max_words{std::size_t{64} << 20U};
    /// Bytes that MonitoredItems may count as together (8.1, CreateMonitoredItems); past it they
    /// answer Bad_TooManyMonitoredItems.
    std::size_t max_monitored_size{std::size_t{1} << 30U};

    /// 25,000 units, 2,048K words, and as many bytes as those words have for MonitoredItems.
    [[nodiscard]] static constexpr MappedLimits rd81opc96()
    {
        constexpr std::size_t words = std::size_t{2'048} << 10U;
        return {25'000, words, 2 * words};
    }
};

struct MappedOptions {
    SamplingMode sampling{SamplingMode::Standard};
    MappedLimits limits{};
    ConversionOptions conversion{};
    /// A label that cannot be used, or whose value its node cannot have, fails the Variables and
    /// Methods that it belongs to; else all of them, or all of the request (8.3).
    bool isolates_failures{false};
    /// How often an operation is begun again because the labels were other ones meanwhile.
    unsigned max_repetitions{3};
    /// As in DataSourceOptions.
    std::chrono::milliseconds timeout{5'000};
    std::size_t max_batches{256};
    std::size_t max_items{4'000'000};
};

/// Event codes of the update of labels' addresses and types (8.3).
enum class LabelUpdate : std::uint16_t { Started = 24'000, Finished = 24'001, Failed = 24'003 };

/// Error codes (8.3).
enum class MappedErrorCode : std::uint16_t {
    Unavailable = 0x1921,         // there is no such label that can be used
    WrongType = 0x1A00,           // a label of a type that the node cannot have
    OutOfRange = 0x1A01,          // its value is none that the node can have
    TooManyPoints = 0x1941,       // to sample in each scan
    UnsampledDevice = 0x1945,     // a label where that is impossible
    SamplingUnsupported = 0x1946, // the PLC has no sampling in each scan
};

struct MappedError {
    MappedErrorCode code;
    /// Empty, and the node null, where an error is about none in particular.
    std::string_view label{};
    const NodeId* node{nullptr};
};

/// Who keeps events and errors. Called on the server's thread, within calls of the MappedSource,
/// which it must not call.
class BUSBAR_API MappedObserver {
public:
    MappedObserver() = default;
    MappedObserver(const MappedObserver&) = delete;
    MappedObserver& operator=(const MappedObserver&) = delete;
    virtual ~MappedObserver() = default;

    virtual void label_update(LabelUpdate event) = 0;
    /// What it refers to is valid until it returns.
    virtual void error(const MappedError& error) = 0;
};

/// Whether the PLC can be reached, as far as the last request to it says.
enum class TargetStatus : std::uint8_t { Unknown, Communicating, Failing };

/// A DataSource of the Variables and Methods that are mapped to labels of one PLC.
///
/// One request of a client is one request to the PLC, or several in a row for a Call, and its nodes
/// succeed or fail together; so do the MonitoredItems of one interval. Their source timestamp is
/// the PLC's time when that was done. If labels are not those that were resolved, all of them are
/// resolved anew and what was asked is repeated; what is asked meanwhile waits, except that
/// MonitoredItems have their last values with Good_Overload (10.3). Labels that cannot be resolved
/// or are of a wrong type make all mapped nodes answer Bad_NoCommunication (8.3) until labels
/// change and the next request finds them well.
///
/// A Write with an IndexRange answers Bad_WriteNotSupported. When the PLC refuses because it has
/// too much to do or stops, and when there are more requests than the options allow, the
/// ServiceResult is Bad_TooManyOperations or Bad_Shutdown, see DataSourceOptions::decides_services;
/// of a Call Bad_Shutdown only (8.1).
///
/// For the server's thread, as any DataSource; the PLC may answer on any thread, which then does
/// nothing but queue the answer. Server, source and requests may end in any order.
class BUSBAR_API MappedSource final : public server::DataSource {
public:
    /// `backend`, not null, has no other listener from start() to stop(). `observer` may be null;
    /// it outlives this.
    explicit MappedSource(std::shared_ptr<backend::LabelBackend> backend,
                          const MappedOptions& options = {}, MappedObserver* observer = nullptr);
    ~MappedSource() override;

    // Before start().

    /// Gives the handle of the node, for AddressSpace::bind. Labels beyond the shape's leaves are
    /// passed over.
    [[nodiscard]] std::uint64_t add(MappedVariable variable);
    [[nodiscard]] std::uint64_t add(MappedMethod method);
    /// Where Calls find out that what they are for is an ObjectType (Bad_NotSupported); must
    /// outlive the source's calls. Without it, that is not found out.
    void set_space(const model::SpaceReader* space);

    /// Resolves all labels, when the nodes are there: before that, they answer Bad_NoCommunication.
    /// Again: resolves them anew. Nothing is done without labels.
    void start();
    /// Lets go of the backend, which another source may be the listener of then: what was asked
    /// answers Bad_NoCommunication, and so does all else until start().
    void stop();

    // The values in buffer memory that the manual names.

    /// Label update running status (Un\G8617).
    [[nodiscard]] bool is_updating() const;
    /// Status of target device 1 (Un\G8448).
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
