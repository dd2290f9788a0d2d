//! Programs that count: an instrumented copy of a program, whose colour encodes the number of texels that a
//! fragment has sampled or loaded, and the number of iterations of its march.
//!
//! The compiled module is instrumented, as by a profiler: the source is the drawing program's, so that the
//! two can't diverge.

use naga::{
    AddressSpace, BinaryOperator, Block, EntryPoint, Expression, Function, GlobalVariable, Handle,
    Literal, MemoryDecorations, Module, Range, Scalar, ScalarKind, Span, Statement, Type,
    TypeInner, VectorSize,
};

/// The counters of a module.
#[derive(Clone, Copy)]
struct Counters {
    fetches: Handle<GlobalVariable>,
    turns: Handle<GlobalVariable>,
    float4: Handle<Type>,
}

/// Makes the fragment program return counts instead of its colour: in red and green the fetches and the
/// turns of its march, each over 255, and in blue 1 if it hit. A fragment that would be discarded returns
/// too, at the far plane.
///
/// A turn is an iteration of an innermost loop, in functions that march and in the entry point.
pub(crate) fn count_fetches_and_turns(module: &mut Module) {
    let counters = Counters::declare(module);
    for (_, function) in module.functions.iter_mut() {
        let name = function.name.clone().unwrap_or_default();
        counters.instrument(function, name.starts_with("march"));
    }
    for entry in &mut module.entry_points {
        counters.instrument(&mut entry.function, true);
        counters.return_counts(entry);
    }
}

impl Counters {
    fn declare(module: &mut Module) -> Self {
        let unnamed = |inner| Type { name: None, inner };
        let count = unnamed(TypeInner::Scalar(Scalar::U32));
        let count = module.types.insert(count, Span::UNDEFINED);
        let color = TypeInner::Vector { size: VectorSize::Quad, scalar: Scalar::F32 };
        let float4 = module.types.insert(unnamed(color), Span::UNDEFINED);
        let zero =
            module.global_expressions.append(Expression::Literal(Literal::U32(0)), Span::UNDEFINED);
        let mut counter = |name: &str| {
            let variable = GlobalVariable {
                name: Some(name.into()),
                space: AddressSpace::Private,
                binding: None,
                ty: count,
                init: Some(zero),
                memory_decorations: MemoryDecorations::empty(),
            };
            module.global_variables.append(variable, Span::UNDEFINED)
        };
        Counters { fetches: counter("counted_fetches"), turns: counter("counted_turns"), float4 }
    }

    fn instrument(self, function: &mut Function, is_march: bool) {
        let body = std::mem::take(&mut function.body);
        function.body = self.instrument_block(function, body, is_march);
    }

    fn instrument_block(self, function: &mut Function, block: Block, is_march: bool) -> Block {
        let mut out = Block::new();
        for (statement, span) in block.span_into_iter() {
            let count = match &statement {
                Statement::Emit(range) => range.clone().filter(|&e| is_fetch(function, e)).count(),
                _ => 0,
            };
            let mut inner = |block| self.instrument_block(function, block, is_march);
            let statement = match statement {
                Statement::Loop { body, continuing, break_if } => {
                    let turn = (is_march && !has_loop(&body)).then(|| length_of_condition(&body));
                    let (mut body, mut counted) = (inner(body), Block::new());
                    if let Some(at) = turn {
                        add(function, &mut counted, self.turns, 1);
                        body.splice(at..at, counted);
                    }
                    let continuing = self.instrument_block(function, continuing, is_march);
                    Statement::Loop { body, continuing, break_if }
                }
                other => map_blocks(other, inner),
            };
            out.push(statement, span);
            if count > 0 {
                add(function, &mut out, self.fetches, count as u32);
            }
        }
        out
    }

    /// Replaces each return of a colour, the first member of the result, and each discard.
    fn return_counts(self, entry: &mut EntryPoint) {
        let function = &mut entry.function;
        let result = function.result.as_ref().expect("a fragment program has a result").ty;
        let body = std::mem::take(&mut function.body);
        function.body = self.replace_returns(function, body, result);
    }

    fn replace_returns(self, function: &mut Function, block: Block, result: Handle<Type>) -> Block {
        let mut out = Block::new();
        for (statement, span) in block.span_into_iter() {
            let statement = match statement {
                Statement::Return { value: Some(value) } => {
                    let depth =
                        emit(function, &mut out, Expression::AccessIndex { base: value, index: 1 });
                    self.return_statement(function, &mut out, result, (1.0, depth))
                }
                Statement::Kill => {
                    let depth = literal(function, Literal::F32(0.0));
                    self.return_statement(function, &mut out, result, (0.0, depth))
                }
                other => map_blocks(other, |block| self.replace_returns(function, block, result)),
            };
            out.push(statement, span);
        }
        out
    }

    /// Composes the result: the counts, whether the fragment hit, and its depth.
    fn return_statement(
        self,
        function: &mut Function,
        block: &mut Block,
        result: Handle<Type>,
        (hit, depth): (f32, Handle<Expression>),
    ) -> Statement {
        let of_255 = literal(function, Literal::F32(1.0 / 255.0));
        let mut part = |counter| {
            let count = load(function, block, counter);
            let convert = Expression::As { expr: count, kind: ScalarKind::Float, convert: Some(4) };
            let left = emit(function, block, convert);
            let op = BinaryOperator::Multiply;
            emit(function, block, Expression::Binary { op, left, right: of_255 })
        };
        let (fetches, turns) = (part(self.fetches), part(self.turns));
        let hit = literal(function, Literal::F32(hit));
        let one = literal(function, Literal::F32(1.0));
        let components = vec![fetches, turns, hit, one];
        let color = emit(function, block, Expression::Compose { ty: self.float4, components });
        let both = Expression::Compose { ty: result, components: vec![color, depth] };
        Statement::Return { value: Some(emit(function, block, both)) }
    }
}

/// Returns a statement with each block in it replaced.
fn map_blocks(statement: Statement, mut map: impl FnMut(Block) -> Block) -> Statement {
    match statement {
        Statement::Block(block) => Statement::Block(map(block)),
        Statement::If { condition, accept, reject } => {
            Statement::If { condition, accept: map(accept), reject: map(reject) }
        }
        Statement::Switch { selector, mut cases } => {
            for case in &mut cases {
                case.body = map(std::mem::take(&mut case.body));
            }
            Statement::Switch { selector, cases }
        }
        Statement::Loop { body, continuing, break_if } => {
            Statement::Loop { body: map(body), continuing: map(continuing), break_if }
        }
        other => other,
    }
}

fn is_fetch(function: &Function, expression: Handle<Expression>) -> bool {
    let expression = &function.expressions[expression];
    matches!(expression, Expression::ImageSample { .. } | Expression::ImageLoad { .. })
}

/// Returns the number of leading statements in a loop's body that test whether the loop continues, as in
/// `while` and `for`. An iteration that ends there isn't counted.
fn length_of_condition(body: &Block) -> usize {
    let asks = |statement: &Statement| match statement {
        Statement::If { accept, reject, .. } => {
            [accept, reject].iter().any(|branch| matches!(branch[..], [Statement::Break]))
        }
        _ => false,
    };
    let before =
        body.iter().take_while(|statement| matches!(statement, Statement::Emit(_))).count();
    if body.get(before).is_some_and(asks) { before + 1 } else { 0 }
}

fn has_loop(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Loop { .. } => true,
        Statement::Block(block) => has_loop(block),
        Statement::If { accept, reject, .. } => has_loop(accept) || has_loop(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| has_loop(&case.body)),
        _ => false,
    })
}

/// Adds a number to a counter.
fn add(function: &mut Function, block: &mut Block, counter: Handle<GlobalVariable>, by: u32) {
    let by = literal(function, Literal::U32(by));
    let left = load(function, block, counter);
    let sum = Expression::Binary { op: BinaryOperator::Add, left, right: by };
    let value = emit(function, block, sum);
    let pointer = append(function, Expression::GlobalVariable(counter));
    block.push(Statement::Store { pointer, value }, Span::UNDEFINED);
}

fn load(
    function: &mut Function,
    block: &mut Block,
    counter: Handle<GlobalVariable>,
) -> Handle<Expression> {
    let pointer = append(function, Expression::GlobalVariable(counter));
    emit(function, block, Expression::Load { pointer })
}

fn literal(function: &mut Function, literal: Literal) -> Handle<Expression> {
    append(function, Expression::Literal(literal))
}

/// Appends an expression that is evaluated at the end of a block.
fn emit(function: &mut Function, block: &mut Block, expression: Expression) -> Handle<Expression> {
    let handle = append(function, expression);
    block.push(Statement::Emit(Range::new_from_bounds(handle, handle)), Span::UNDEFINED);
    handle
}

fn append(function: &mut Function, expression: Expression) -> Handle<Expression> {
    function.expressions.append(expression, Span::UNDEFINED)
}
