#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <span>
#include <vector>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/trust_list.hpp>
#include <busbar/server/server.hpp>

#include "node_table.hpp"
#include "transaction.hpp"

namespace busbar::administration::detail {

// Two functions convert a trust list from and to the bytes of a file (Part 12, 7.8.2.8,
// TrustListDataType).

/// All bits of TrustListMasks.
inline constexpr std::uint32_t all_lists = 15;

/// Encodes the lists in the masks; the others are empty.
[[nodiscard]] std::vector<std::byte> bytes_of(const crypto::TrustList& list, std::uint32_t masks);

/// Replaces those lists of `list` that `bytes` specify; sets `parts` accordingly.
/// Bad_InvalidArgument for other bytes, Bad_CertificateInvalid for elements that cannot be read.
[[nodiscard]] Checked<crypto::TrustList>
merge(std::span<const std::byte> bytes, crypto::TrustList list, crypto::TrustListParts& parts);

/// The parts of ServerConfiguration that TrustList objects use.
struct TrustListNeeds {
    server::Server& server;
    NodeTable& table;
    Transaction& transaction;
    const ManagedCertificates& files;
    const WallClock& clock;
    LogSink& log;
    /// Raised when the group's list changes.
    NodeTable::Signal& changed;
};

/// A TrustList object (Part 12, 7.8.2): the list of a CertificateGroup as a file. Sessions read the
/// present list; writing changes it in the transaction.
class TrustListFile {
public:
    TrustListFile(const TrustListNeeds& needs, std::size_t group);

    void attach(model::NodeIndex node);
    /// True while a session has the list open for writing.
    [[nodiscard]] bool is_open_for_writing() const;
    /// Closes the files of sessions that are gone.
    void expire();
    /// Reports a change of the list.
    void tell_changed() { needs_.table.raise(needs_.changed); }

private:
    struct Open {
        std::uint32_t handle;
        Holder holder;
        bool is_writing;
        std::vector<std::byte> bytes;
        std::size_t position;
        std::uint32_t version;
    };

    void bind(model::NodeIndex node, std::string_view name,
              void (TrustListFile::*function)(server::MethodCall));
    void bind_values(model::NodeIndex node);
    void open(server::MethodCall call);
    void open_with_masks(server::MethodCall call);
    void open_reading(server::MethodCall call, std::uint32_t masks);
    void close(server::MethodCall call);
    void read(server::MethodCall call);
    void write(server::MethodCall call);
    void get_position(server::MethodCall call);
    void set_position(server::MethodCall call);
    void close_and_update(server::MethodCall call);
    void add_certificate(server::MethodCall call);
    void remove_certificate(server::MethodCall call);

    [[nodiscard]] CertificateGroup& group() { return needs_.transaction.groups()[group_]; }
    /// Finds the session's open file by the handle in the call's first input; null if there is
    /// none.
    [[nodiscard]] Open* find(const server::MethodCall& call);
    void forget(const Open& open);
    /// Adds the file and answers the call; false if it was refused.
    [[nodiscard]] bool keep(server::MethodCall& call, Open open);
    /// Makes room for a file with these bytes; files that other users only read may give way.
    [[nodiscard]] bool make_room(const Holder& holder, std::size_t bytes);
    /// Good if the list may be changed without a transaction.
    [[nodiscard]] std::string too_large() const;
    [[nodiscard]] StatusCode check_single_change() const;
    /// Adds the certificate to the trusted ones, or moves it there from the rejected ones.
    [[nodiscard]] Checked<void> trust(const crypto::Certificate& certificate);
    /// Removes the certificate from the list, with the revocation lists of a CA.
    [[nodiscard]] Checked<void> take_out(const crypto::Certificate& certificate, bool is_trusted);
    /// Records the call; it was refused unless `refusal` is null.
    void tell(const server::MethodCall& call, const Refusal* refusal);
    void refuse_call(server::MethodCall& call, const Refusal& refusal);

    TrustListNeeds needs_;
    model::NodeIndex close_and_update_{model::no_node};
    std::size_t group_;
    std::list<Open> open_; // oldest first
    std::uint32_t last_handle_{0};
};

} // namespace busbar::administration::detail
