#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tool/printing/value_type.hpp"
#include "tool/stream/stream.hpp"

namespace busbar::tool::watch {

/// Writes one value after another without waiting, so that the view stays live. Handlers are called
/// in run() of the Stream; a handler that was not called before the next write never is.
class LiveWriter {
public:
    LiveWriter(Connection& connection, Stream& stream) : connection_{&connection}, stream_{&stream}
    {
    }

    /// Empty if the value may be written; else why not.
    using Prepared = std::function<void(const std::string& type, const std::string& refusal)>;
    /// Asks what the node takes: "Int16[]".
    void prepare(const client::NodeAddress& node, Prepared done);

    struct Outcome {
        StatusCode status;
        /// An error in the text; empty if it was sent to the server.
        std::string problem;
    };
    /// Writes to the node of the last prepare() that ended well.
    void write(const std::string& text, std::function<void(const Outcome&)> done);

private:
    void ask(const NodeId& node);
    void take(std::vector<DataValue> attributes);
    void ready();
    /// Calls `work` unless another prepare() came meanwhile.
    void later(std::function<void()> work);

    Connection* connection_;
    Stream* stream_;
    std::uint64_t round_{0};
    Prepared prepared_;
    NodeId node_;
    NodeId data_type_;
    std::int32_t value_rank_{-2};
};

} // namespace busbar::tool::watch
