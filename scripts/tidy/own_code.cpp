// Loaded into clang-tidy: leaves out of the analysis what system headers declare.
//
// Findings in system headers are never shown, yet every check walks through all of them, with all
// that was instantiated of Eigen and the standard library: more than half of the time. The analysis
// of Clang 21 leaves them out by itself; this does so for the one of Debian 12, by the same means
// as clangd does.
#include "clang-tidy/ClangTidyCheck.h"
#include "clang-tidy/ClangTidyModule.h"
#include "clang-tidy/ClangTidyModuleRegistry.h"
#include "clang/AST/ASTContext.h"
#include "clang/ASTMatchers/ASTMatchFinder.h"
#include "clang/ASTMatchers/ASTMatchers.h"

namespace {

using clang::ast_matchers::MatchFinder;

// The whole unit is visited first: what then is to be visited of it is chosen here.
class OwnCode : public clang::tidy::ClangTidyCheck {
 public:
  using ClangTidyCheck::ClangTidyCheck;

  void registerMatchers(MatchFinder* finder) override {
    finder->addMatcher(clang::ast_matchers::translationUnitDecl().bind("unit"), this);
  }

  void check(const MatchFinder::MatchResult& result) override {
    const auto* unit = result.Nodes.getNodeAs<clang::TranslationUnitDecl>("unit");
    if (unit == nullptr) return;
    std::vector<clang::Decl*> own;
    for (clang::Decl* declaration : unit->decls()) {
      const clang::SourceLocation place = declaration->getLocation();
      if (place.isValid() && !result.SourceManager->isInSystemHeader(place))
        own.push_back(declaration);
    }
    result.Context->setTraversalScope(own);
  }
};

class OwnCodeModule : public clang::tidy::ClangTidyModule {
 public:
  void addCheckFactories(clang::tidy::ClangTidyCheckFactories& factories) override {
    factories.registerCheck<OwnCode>("offnominal-own-code");
  }
};

const clang::tidy::ClangTidyModuleRegistry::Add<OwnCodeModule> kRegistered(
    "offnominal", "leaves system headers out");

}  // namespace
