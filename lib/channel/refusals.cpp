#include "refusals.hpp"

#include <algorithm>
#include <array>

namespace busbar::channel::detail {

namespace {

struct Rule {
    StatusCode status;
    std::string_view check;
    std::string_view found;
    std::string_view rule;
    std::string_view remedy;
};

constexpr std::string_view broken_peer = "The peer's OPC UA stack is at fault";
constexpr std::string_view not_ua = "Find out what connects to this port";

constexpr std::array rules = {
    Rule{status::Bad_TcpMessageTypeInvalid, "message type",
         "an unexpected message, or bytes that are not OPC UA", "Part 6, 7.1.2.2", not_ua},
    Rule{status::Bad_TcpMessageTooLarge, "message size",
         "a chunk, a message or a number of chunks above the agreed limits",
         "Part 6, 6.7.3 and 7.1.2.3",
         "Raise the transport limits if the peer is meant to send that much"},
    Rule{status::Bad_TcpNotEnoughResources,
         "resources",
         "buffers of the peer too small, or no memory left for unfinished messages",
         "Part 6, 7.1.2.3",
         {}},
    Rule{status::Bad_TcpServerTooBusy, "OpenSecureChannel",
         "more from this address than it may ask for, or after too many that failed",
         "Part 2, 5.1.2.2; limits channel_interval and failed_channel_interval",
         "Find out which client connects so often, and why its channels fail"},
    Rule{status::Bad_TcpInternalError, "Hello", "a Hello that cannot be read", "Part 6, 7.1.2.3",
         not_ua},
    Rule{status::Bad_TcpEndpointUrlInvalid, "endpoint URL", "none, or one of more than 4,096 bytes",
         "Part 6, 7.1.2.3", "Correct the URL in the peer's settings"},
    Rule{status::Bad_TcpSecureChannelUnknown, "SecureChannelId",
         "the id of another channel than this connection's", "Part 6, 6.7.2.4", broken_peer},
    Rule{status::Bad_SecureChannelTokenUnknown, "SecurityToken",
         "a token that was never issued or has expired", "Part 4, 5.6.2.1",
         "The peer has to renew its token earlier; both clocks count, not the time of day"},
    Rule{status::Bad_SequenceNumberInvalid, "sequence number",
         "a chunk that was repeated, left out or put elsewhere", "Part 6, 6.7.2.4",
         "The connection may have been tampered with on its way"},
    Rule{status::Bad_SecurityChecksFailed, "message security",
         "signature or padding of a chunk do not fit the channel's keys", "Part 6, 6.7.7",
         "The connection may have been tampered with on its way"},
    Rule{status::Bad_DecodingError, "message body", "bytes that are not the structure they claim",
         "Part 6, 5.2", broken_peer},
    Rule{status::Bad_Timeout,
         "handshake",
         "no open channel within the time that is given",
         "Part 6, 7.1.3",
         {}},
    Rule{status::Bad_ResourceUnavailable, "random numbers", "the source gave none", "Part 6, 6.7.4",
         "Look after this machine's source of random numbers"},
};

} // namespace

Refusal protocol_refusal(StatusCode status)
{
    const auto rule =
        std::find_if(rules.begin(), rules.end(), [&](const Rule& r) { return r.status == status; });
    if (rule == rules.end()) {
        return {status, "message", {}, "Part 6, 6.7.7", {}};
    }
    return {status, rule->check, std::string{rule->found}, rule->rule, std::string{rule->remedy}};
}

} // namespace busbar::channel::detail
