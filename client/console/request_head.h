// The head of a request as the gateway looks at it.
#pragma once

// Boost 1.74 uses std::exchange without including it.
#include <utility>

#include <boost/beast/http/message.hpp>

#include "client/console/gateway/web.h"

namespace handrail {

// Without from and network. A Host that is said twice is none.
WebRequest read_head(const boost::beast::http::request_header<>& head);

}  // namespace handrail
