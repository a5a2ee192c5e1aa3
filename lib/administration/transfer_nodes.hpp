#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/file_transfer.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/data_source.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/server/server.hpp>
#include <busbar/server/worker.hpp>

#include "call_turns.hpp"
#include "file_objects.hpp"
#include "node_table.hpp"
#include "transfer_files.hpp"

namespace busbar::administration::detail {

/// The Object of one TemporaryFileTransfer and the Objects of its files. Each file has its own
/// Methods: shared ones would have references from one session's file to those of others.
class TransferNodes final : public server::DataSource {
public:
    /// All members must outlive the object.
    struct Needs {
        server::Server& server;
        const TemporaryFileTransfer& transfer;
        crypto::Random& random;
        const WallClock& clock;
        LogSink& log;
        NodeTable& table;
        /// Processes files; if null, the server's thread does.
        server::Worker* worker;
    };

    explicit TransferNodes(const Needs& needs);

    /// Adds the nodes. Fails if namespace 0 is too small or a node exists already.
    [[nodiscard]] Configured<void> add_nodes();

    [[nodiscard]] server::DataSourceOptions options() const override
    {
        return own_source_options();
    }
    void read(server::ReadBatch batch) override;
    void call(server::CallBatch batch) override { turns_.add(std::move(batch)); }
    void attach(server::Waker* waker) override { turns_.attach(waker); }
    void handle_completions() override { turns_.serve_next(); }

private:
    using Method = void (TransferNodes::*)(server::MethodCall& call);
    struct Declared {
        std::uint32_t declaration;
        Method method;
        bool changes;
    };
    /// Indexed by the handles of Methods: those of the transfer, then those of its files.
    static const std::array<Declared, 9> declared;
    static constexpr std::size_t methods_of_transfer = 3;

    void serve(const std::shared_ptr<server::CallBatch>& batch, std::size_t index);
    [[nodiscard]] Result<void> add_objects();
    [[nodiscard]] Result<void> add_method(std::size_t which, model::NodeIndex parent);
    [[nodiscard]] Result<void> add_timeout(model::NodeIndex transfer);
    [[nodiscard]] NamedRoles roles() const;
    [[nodiscard]] NodeId node_id(std::string_view below) const;
    /// Returns a name that cannot be guessed.
    [[nodiscard]] Result<std::string> new_name();
    /// Returns the name of the Object that is called; empty if it is not one of these files.
    [[nodiscard]] std::string_view name_of(const NodeId& object) const;
    [[nodiscard]] TransferFile* file_of(const server::MethodCall& call);
    [[nodiscard]] TimePoint now() const;
    void expire();
    void drop(const TransferFile& file);
    void remove_nodes(const std::string& name);
    /// Adds the file and its Object, or neither. Returns the outputs of the Method.
    [[nodiscard]] Result<Array<Variant>> keep(TransferFile file);
    [[nodiscard]] Result<void> add_file(const std::string& name);
    [[nodiscard]] DataValue value_of(const TransferFile& file, FileAspect aspect) const;

    void generate_for_read(server::MethodCall& call);
    void generate_for_write(server::MethodCall& call);
    void close_and_commit(server::MethodCall& call);
    /// Answers the call; `file` may be gone.
    void end_taking(server::MethodCall& call, TransferFile* file, StatusCode taken,
                    Array<Variant> outputs, std::string reason);
    void open(server::MethodCall& call);
    void close(server::MethodCall& call);
    void read_file(server::MethodCall& call);
    void write_file(server::MethodCall& call);
    void get_position(server::MethodCall& call);
    void set_position(server::MethodCall& call);

    server::Server& server_;
    model::AddressSpace& space_;
    const TemporaryFileTransfer& transfer_;
    crypto::Random& random_;
    const WallClock& clock_;
    NodeTable& table_;
    server::Worker* worker_;
    bool is_taking_{false}; // true while a file is processed on the worker
    TransferFiles files_;
    CallTurns turns_;
    std::uint16_t namespace_{0};
    /// Parent of the files' Objects, which no client can see.
    model::NodeIndex container_{model::no_node};
    /// Names of the files by the numbers in their Variables' handles.
    std::vector<std::string> numbers_;
};

} // namespace busbar::administration::detail
